// This file opens EXR pictures from bytes, for every reader of them: headers are checked before OpenEXR
// allocates what they claim, and the first part that holds the wanted channels is found.
#pragma once

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/tracer/image.h"

namespace sunbeam {

// Names channels, and where their values go: pixel by pixel, rows from the top of the data window.
struct ExrRequest {
  std::vector<std::string> channels;
  std::vector<float>* values = nullptr;
};

// Every function throws Error, whose message begins with the name.
class ExrSource {
 public:
  // `bytes` must outlive this. `name` is that of the file.
  ExrSource(std::string_view bytes, const std::string& name);
  ~ExrSource();

  // Goes to the first part with all of these channels, sampled at every pixel unless `subsampled`. Returns
  // whether there is one.
  bool find_part(const std::vector<std::string>& channels, bool subsampled = false);
  // Throws what says which channels the file has, up to ten of them.
  [[noreturn]] void fail_for_channels(const std::string& allowed) const;
  [[noreturn]] void fail(const std::string& what) const;

  // All below are of the part found last.
  const Imf::Header& header() const { return file_->header(part_); }
  int part() const { return part_; }
  bool has_channel(const std::string& name) const;
  // Returns the data window in the display window. It may reach beyond.
  PixelWindow window() const;
  // Throws Error if so many bytes for every pixel of the data window are more than the file may ask for.
  void require_memory(std::uint64_t bytes_per_pixel) const;
  // Reads values of any pixel type as float, of mip-mapped tiles the largest level. Asks for their memory.
  void read(const std::vector<ExrRequest>& requests);
  // Reads R, G and B, interleaved, of a part that holds Y, RY and BY.
  std::vector<float> read_luminance_chroma();

 private:
  class Stream;

  // Calls what calls OpenEXR, and turns its exceptions into Error.
  template <class Call>
  void guarded(Call call) const;

  std::string_view bytes_;
  std::string name_;
  std::unique_ptr<Stream> stream_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  int part_ = 0;
};

}  // namespace sunbeam
