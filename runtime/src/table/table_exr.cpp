// Table <-> multi-part OpenEXR. One part an array: x runs over the last two axes, y over all others
// (row-major), channels R, G, B, or Y alone for single numbers. The first part carries the table's
// attributes, every part the axes of its array.
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>

#include <cstring>
#include <utility>

#include "runtime/src/base/attempt.h"
#include "runtime/src/table/table_parts.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/exr_headers.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_io.h"

namespace sunbeam {
inline namespace v1 {
namespace {

struct ImageSize {
  int width, height;
};

ImageSize image_size(const ArrayShape& array) {
  const auto& axes = array.axes();
  const std::size_t first_of_row = axes.size() >= 2 ? axes.size() - 2 : 0;
  const std::size_t width = axes[first_of_row].size() * array.stride(first_of_row);
  const std::size_t height = array.cells() / width;
  constexpr std::size_t kLargestImage = 1u << 30;
  if (width > kLargestImage || height > kLargestImage)
    throw Error("array '" + array.name() + "' is too large for an EXR part");
  return {static_cast<int>(width), static_cast<int>(height)};
}

std::vector<std::string> channel_names(std::size_t channels) {
  return channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
}

Imf::FrameBuffer frame_buffer(void* values, Imf::PixelType type, std::size_t value_bytes,
                              std::size_t channels, int width) {
  Imf::FrameBuffer buffer;
  auto* base = static_cast<char*>(values);
  const std::size_t pixel = channels * value_bytes;
  const auto names = channel_names(channels);
  for (std::size_t c = 0; c < channels; ++c)
    buffer.insert(names[c],
                  Imf::Slice(type, base + c * value_bytes, pixel, pixel * static_cast<std::size_t>(width)));
  return buffer;
}

Imf::Header part_header(const ArrayShape& array, const Imath::Box2i& display_window) {
  const ImageSize size = image_size(array);
  Imf::Header header(display_window, Imath::Box2i({0, 0}, {size.width - 1, size.height - 1}));
  header.setName(array.name());
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  const auto type = array.precision() == Precision::half_float ? Imf::HALF : Imf::FLOAT;
  for (const auto& channel : channel_names(array.channels()))
    header.channels().insert(channel, Imf::Channel(type));
  for (const auto& [key, value] : describe_axes(array.axes()))
    header.insert(kAttributePrefix + key, Imf::StringAttribute(value));
  return header;
}

// The next rows of a part. The library finds a row by its number from the top of the image, hence the offset.
template <class Value>
void write_rows(Imf::OutputPart& output, Imf::PixelType type, Value* values, std::size_t count,
                std::size_t channels, int width) {
  const std::size_t row = channels * static_cast<std::size_t>(width);
  const auto before = static_cast<std::size_t>(output.currentScanLine()) * row * sizeof(Value);
  output.setFrameBuffer(
      frame_buffer(reinterpret_cast<char*>(values) - before, type, sizeof(Value), channels, width));
  output.writePixels(static_cast<int>(count / row));
}

// Half values go to the library as halves: it converts floats only when reading.
void write_array(Imf::MultiPartOutputFile& file, int part, const ArrayView& view) {
  const ArrayShape& array = view.shape();
  Imf::OutputPart output(file, part);
  const int width = image_size(array).width;
  view.visit([&](std::span<const float> values) {
    if (array.precision() == Precision::half_float) {
      std::vector<Imath::half> halves(values.begin(), values.end());
      write_rows(output, Imf::HALF, halves.data(), halves.size(), array.channels(), width);
    } else {
      std::vector<float> floats(values.begin(), values.end());
      write_rows(output, Imf::FLOAT, floats.data(), floats.size(), array.channels(), width);
    }
  });
}

// The library's writer into a file that is not there until it is whole.
class AtomicStream : public Imf::OStream {
 public:
  explicit AtomicStream(AtomicFile& file, const std::string& path) : OStream(path.c_str()), file_(file) {}

  void write(const char bytes[], int count) override {
    file_.write({bytes, static_cast<std::size_t>(count)});
  }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  AtomicFile& file_;
};

// The library's reader over bytes in memory.
class MemoryStream : public Imf::IStream {
 public:
  MemoryStream(std::string_view bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}

  bool read(char target[], int count) override {
    if (static_cast<std::size_t>(count) > bytes_.size() - position_) throw Error("the file ends too early");
    std::memcpy(target, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw Error("the file ends too early");
    position_ = position;
  }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

Attributes string_attributes(const Imf::Header& header) {
  Attributes result;
  const std::string prefix = kAttributePrefix;
  for (auto at = header.begin(); at != header.end(); ++at) {
    const std::string name = at.name();
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&at.attribute());
    if (text && name.starts_with(prefix)) result[name.substr(prefix.size())] = text->value();
  }
  return result;
}

// The pixel type of channels R, G and B, or of Y alone; there must be no other.
Imf::PixelType pixel_type(const Imf::Header& header, const std::string& name) {
  const Imf::ChannelList& channels = header.channels();
  const Imf::Channel* first = channels.findChannel("Y");
  const std::size_t expected = first ? 1 : 3;
  if (!first) first = channels.findChannel("R");
  if (!first || (first->type != Imf::HALF && first->type != Imf::FLOAT))
    throw Error("part '" + name + "' is not a table array: it has no half or float channel R or Y");
  std::size_t count = 0;
  for (auto at = channels.begin(); at != channels.end(); ++at, ++count)
    if (at.channel().type != first->type || at.channel().xSampling != 1 || at.channel().ySampling != 1)
      throw Error("part '" + name + "' is not a table array: channel '" + at.name() +
                  "' has another type or sampling than '" + (expected == 1 ? "Y'" : "R'"));
  const bool has_all = expected == 1 || (channels.findChannel("G") && channels.findChannel("B"));
  if (count != expected || !has_all)
    throw Error("part '" + name + "' is not a table array: it has " + std::to_string(count) +
                " channels; allowed: R, G and B, or Y alone");
  return first->type;
}

// The array that a part holds, without its values. Its axes are held against the data window.
ArrayShape read_shape(const Imf::Header& header) {
  const std::string name = header.hasName() ? header.name() : "";
  const Attributes attributes = string_attributes(header);
  if (!attributes.count("axis.0.name"))
    throw Error("part '" + name + "' is not a table array: it has no sunbeam.axis.* attributes");
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE)
    throw Error("part '" + name + "' is of type '" + header.type() + "'; allowed: scanlineimage");
  const Imf::PixelType type = pixel_type(header, name);
  ArrayShape shape(name, parse_axes(attributes, name),
                   type == Imf::HALF ? Precision::half_float : Precision::single_float,
                   header.channels().findChannel("Y") ? 1 : 3);
  const ImageSize size = image_size(shape);
  if (header.dataWindow() != Imath::Box2i({0, 0}, {size.width - 1, size.height - 1}))
    throw Error("array '" + name + "': the image size does not agree with the axes");
  return shape;
}

NdArray read_array(Imf::MultiPartInputFile& file, int part) {
  NdArray array(read_shape(file.header(part)));
  const ImageSize size = image_size(array);
  Imf::InputPart input(file, part);
  input.setFrameBuffer(
      frame_buffer(array.values().data(), Imf::FLOAT, sizeof(float), array.channels(), size.width));
  input.readPixels(0, size.height - 1);
  return array;
}

TableParts read_parts(std::string_view bytes, const std::string& name) {
  MemoryStream stream(bytes, name);
  Imf::MultiPartInputFile file(stream);
  TableParts parts;
  parts.attributes = string_attributes(file.header(0));
  std::erase_if(parts.attributes, [](const auto& entry) { return entry.first.starts_with("axis."); });
  if (!parts.attributes.count("schema_version"))
    throw Error("it is an OpenEXR file, but not a Sunbeam table");
  for (int part = 0; part < file.parts(); ++part) parts.arrays.push_back(read_array(file, part));
  return parts;
}

void write_table(Imf::OStream& stream, const TableView& table) {
  const Attributes attributes = attributes_of(table);
  const std::vector<ArrayView> arrays = table.arrays();
  Imath::Box2i display_window({0, 0}, {0, 0});  // one for all parts, as the format wants it
  for (const ArrayView& array : arrays) {
    const ImageSize size = image_size(array.shape());
    display_window.extendBy(Imath::V2i(size.width - 1, size.height - 1));
  }
  std::vector<Imf::Header> headers;
  for (const ArrayView& array : arrays) headers.push_back(part_header(array.shape(), display_window));
  for (const auto& [key, value] : attributes)
    headers.front().insert(kAttributePrefix + key, Imf::StringAttribute(value));
  Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()));
  for (std::size_t k = 0; k < arrays.size(); ++k) write_array(file, static_cast<int>(k), arrays[k]);
}

}  // namespace

std::string table_exr_bytes(const TableView& table) {
  Imf::StdOSStream stream;
  write_table(stream, table);
  return stream.str();
}

Table parse_table_exr(std::string_view bytes, const std::string& name) {
  if (bytes.size() < 8 || !Imf::isImfMagic(bytes.data())) throw Error(name + ": not an OpenEXR file");
  check_exr_headers(bytes, name);
  TableParts parts;
  try {
    parts = read_parts(bytes, name);
  } catch (const std::exception& error) {
    throw Error(name + ": cannot read the table: " + error.what());
  }
  return from_parts(std::move(parts), name);
}

Result<Table> try_load_table_exr(const std::string& path) {
  return attempt([&] { return load_table_exr(path); });
}

Table load_table_exr(const std::string& path) { return parse_table_exr(read_file(path), path); }

void save_table_exr(const TableView& table, const std::string& path) {
  AtomicFile file(path);
  AtomicStream stream(file, path);
  write_table(stream, table);
  file.keep();
}

}  // namespace v1
}  // namespace sunbeam
