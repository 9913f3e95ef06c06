#include "runtime/tracer/exr_source.h"

#include <ImfChannelList.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfRgba.h>
#include <ImfRgbaFile.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>

#include "runtime/tracer/image_io.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/exr_headers.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {

// Reads from memory and knows its end.
class ExrSource::Stream : public Imf::IStream {
 public:
  Stream(std::string_view bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}

  bool read(char* to, int count) override {
    if (count < 0 || position_ > bytes_.size() ||
        bytes_.size() - position_ < static_cast<std::uint64_t>(count))
      throw Error("the file ends early");
    std::memcpy(to, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::uint64_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

namespace {

// `min` is the corner of the data window: OpenEXR addresses pixels by absolute coordinates.
void insert_slices(Imf::FrameBuffer& buffer, const ExrRequest& request, int width, const Imath::V2i& min) {
  const std::size_t pixel = request.channels.size() * sizeof(float);
  const std::size_t row = pixel * static_cast<std::size_t>(width);
  char* base = reinterpret_cast<char*>(request.values->data());
  for (const std::string& channel : request.channels) {
    char* origin =
        base - static_cast<std::ptrdiff_t>(pixel) * min.x - static_cast<std::ptrdiff_t>(row) * min.y;
    buffer.insert(channel, Imf::Slice(Imf::FLOAT, origin, pixel, row));
    base += sizeof(float);
  }
}

bool has_channels(const Imf::Header& header, const std::vector<std::string>& names, bool subsampled) {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    return channel && (subsampled || (channel->xSampling == 1 && channel->ySampling == 1));
  });
}

}  // namespace

template <class Call>
void ExrSource::guarded(Call call) const {
  try {
    call();
  } catch (const std::exception& error) {
    fail(printable(error.what()));
  }
}

ExrSource::ExrSource(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {
  if (!is_exr(bytes)) fail("it is no EXR file");
  check_exr_headers(bytes, name);
  stream_ = std::make_unique<Stream>(bytes, name);
  guarded([&] { file_ = std::make_unique<Imf::MultiPartInputFile>(*stream_, 0); });
}

ExrSource::~ExrSource() = default;

void ExrSource::fail(const std::string& what) const {
  throw Error(fmt::format("{}: cannot read the EXR file: {}", name_, what));
}

bool ExrSource::find_part(const std::vector<std::string>& channels, bool subsampled) {
  for (int part = 0; part < file_->parts(); ++part)
    if (has_channels(file_->header(part), channels, subsampled)) {
      part_ = part;
      return true;
    }
  return false;
}

void ExrSource::fail_for_channels(const std::string& allowed) const {
  constexpr std::size_t kMostNames = 10;
  std::vector<std::string> names;
  std::size_t count = 0;
  for (int part = 0; part < file_->parts(); ++part) {
    const Imf::ChannelList& list = file_->header(part).channels();
    for (auto it = list.begin(); it != list.end(); ++it)
      if (++count <= kMostNames) names.push_back(printable(it.name()));
  }
  const std::string more = count > kMostNames ? fmt::format(" and {} more", count - kMostNames) : "";
  fail(fmt::format("found channels {}{}; allowed: {}", fmt::join(names, ", "), more, allowed));
}

bool ExrSource::has_channel(const std::string& name) const { return has_channels(header(), {name}, false); }

PixelWindow ExrSource::window() const {
  const Imath::Box2i whole = header().displayWindow(), part = header().dataWindow();
  const auto from_corner = [&](long x, long corner) {
    const long distance = x - corner;
    if (std::abs(distance) >= std::numeric_limits<int>::max()) fail("its windows are too large");
    return static_cast<int>(distance);
  };
  return {from_corner(whole.max.x + 1L, whole.min.x), from_corner(whole.max.y + 1L, whole.min.y),
          from_corner(part.min.x, whole.min.x),       from_corner(part.min.y, whole.min.y),
          from_corner(part.max.x + 1L, whole.min.x),  from_corner(part.max.y + 1L, whole.min.y)};
}

void ExrSource::require_memory(std::uint64_t bytes_per_pixel) const {
  const PixelWindow w = window();
  require_picture_memory(name_, w.columns(), w.rows(), bytes_per_pixel, bytes_.size());
}

void ExrSource::read(const std::vector<ExrRequest>& requests) {
  const PixelWindow w = window();
  std::size_t channels = 0;
  for (const ExrRequest& request : requests) channels += request.channels.size();
  require_memory(channels * sizeof(float));
  Imf::FrameBuffer buffer;
  const Imath::Box2i data = header().dataWindow();
  for (const ExrRequest& request : requests) {
    request.values->resize(request.channels.size() * static_cast<std::size_t>(w.columns()) *
                           static_cast<std::size_t>(w.rows()));
    insert_slices(buffer, request, w.columns(), data.min);
  }
  guarded([&] {
    Imf::InputPart part(*file_, part_);
    part.setFrameBuffer(buffer);
    part.readPixels(data.min.y, data.max.y);
  });
}

std::vector<float> ExrSource::read_luminance_chroma() {
  if (part_ != 0) fail("a later part holds Y, RY and BY; allowed: the first one, or R, G and B");
  const PixelWindow w = window();
  require_memory(sizeof(Imf::Rgba) + 3 * sizeof(float));
  const std::size_t width = static_cast<std::size_t>(w.columns());
  std::vector<Imf::Rgba> pixels(width * static_cast<std::size_t>(w.rows()));
  const Imath::Box2i data = header().dataWindow();
  guarded([&] {
    Stream stream(bytes_, name_);
    Imf::RgbaInputFile file(stream, 0);
    file.setFrameBuffer(pixels.data() - data.min.x - static_cast<std::ptrdiff_t>(width) * data.min.y, 1,
                        width);
    file.readPixels(data.min.y, data.max.y);
  });
  std::vector<float> rgb;
  rgb.reserve(3 * pixels.size());
  for (const Imf::Rgba& pixel : pixels) rgb.insert(rgb.end(), {pixel.r, pixel.g, pixel.b});
  return rgb;
}

}  // namespace sunbeam
