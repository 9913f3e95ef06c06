#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "runtime/tracer/height_map.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

constexpr long kMaxPixels = 1L << 28;
constexpr double kMaxHeight = 1e6;

HeightMap empty_map(long width, long height) {
  if (width < 1 || height < 1 || width > kMaxPixels || height > kMaxPixels || width * height > kMaxPixels)
    throw Error(fmt::format("found {} x {} pixels; allowed: 1 to {} in all", width, height, kMaxPixels));
  HeightMap map{static_cast<int>(width), static_cast<int>(height), {}};
  map.values.resize(static_cast<std::size_t>(width * height));
  return map;
}

// `min` is the corner of the data window: OpenEXR addresses pixels by absolute coordinates.
Imf::Slice slice_of(const HeightMap& map, const Imath::V2i& min) {
  const std::size_t row = sizeof(float) * static_cast<std::size_t>(map.width);
  // The slice type is shared by reading and writing and hence not const; writing only reads through it.
  char* base = reinterpret_cast<char*>(const_cast<float*>(map.values.data()));
  return {
      Imf::FLOAT,
      base - static_cast<std::ptrdiff_t>(sizeof(float)) * min.x - static_cast<std::ptrdiff_t>(row) * min.y,
      sizeof(float), row};
}

HeightMap read_exr_heights(const std::string& path) {
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  const Imath::Box2i window = header.dataWindow();
  HeightMap map = empty_map(long{window.max.x} - window.min.x + 1, long{window.max.y} - window.min.y + 1);
  const char* channel = header.channels().findChannel("Y") ? "Y" : "R";
  if (!header.channels().findChannel(channel))
    throw Error("found neither channel Y nor R; allowed: one of them");
  Imf::FrameBuffer buffer;
  buffer.insert(channel, slice_of(map, window.min));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return map;
}

std::string exr_bytes(const HeightMap& map) {
  Imf::Header header(map.width, map.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  Imf::FrameBuffer buffer;
  buffer.insert("Y", slice_of(map, {0, 0}));
  Imf::StdOSStream stream;
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(buffer);
    file.writePixels(map.height);
  }  // the table of line offsets is written at the end
  return stream.str();
}

template <class Byte>
void read_png_values(png_image& png, HeightMap& map) {
  std::vector<Byte> values(map.values.size());
  if (!png_image_finish_read(&png, nullptr, values.data(), 0, nullptr)) throw Error(png.message);
  std::transform(values.begin(), values.end(), map.values.begin(), [](Byte value) {
    return static_cast<float>(value) / static_cast<float>(std::numeric_limits<Byte>::max());
  });
}

HeightMap read_png_heights(const std::string& path) {
  const std::string bytes = read_file(path);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) throw Error(png.message);
  const bool is_wide = png.format & PNG_FORMAT_FLAG_LINEAR;
  png.format = is_wide ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
  try {
    HeightMap map = empty_map(png.width, png.height);
    if (is_wide)
      read_png_values<png_uint_16>(png, map);
    else
      read_png_values<png_byte>(png, map);
    png_image_free(&png);
    return map;
  } catch (...) {
    png_image_free(&png);
    throw;
  }
}

std::string png_bytes(const HeightMap& map) {
  std::vector<png_uint_16> values;
  values.reserve(map.values.size());
  for (const float value : map.values)
    values.push_back(static_cast<png_uint_16>(std::lround(65535 * std::clamp(value, 0.0f, 1.0f))));
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(map.width);
  png.height = static_cast<png_uint_32>(map.height);
  png.format = PNG_FORMAT_LINEAR_Y;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, values.data(), 0, nullptr))
    throw Error(fmt::format("cannot encode the heights as PNG: {}", png.message));
  bytes.resize(size);
  return bytes;
}

void require_sane(const HeightMap& map) {
  for (const float value : map.values)
    if (!(std::abs(value) <= kMaxHeight))
      throw Error(
          fmt::format("holds the height {:g}; allowed: {:g} to {:g}", value, -kMaxHeight, kMaxHeight));
}

}  // namespace

void require_height_map_extension(const std::string& path) {
  const std::string type = extension(path);
  if (type != ".exr" && type != ".png")
    throw Error(fmt::format("{}: extension is '{}'; allowed for heights: .exr, .png", path, type));
}

HeightMap load_height_map(const std::string& path) {
  require_height_map_extension(path);
  try {
    const HeightMap map = extension(path) == ".exr" ? read_exr_heights(path) : read_png_heights(path);
    require_sane(map);
    return map;
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: cannot read the height map: {}", path, error.what()));
  }
}

void write_height_map(const std::string& path, const HeightMap& map) {
  require_height_map_extension(path);
  write_file_atomically(path, extension(path) == ".exr" ? exr_bytes(map) : png_bytes(map));
}

}  // namespace sunbeam
