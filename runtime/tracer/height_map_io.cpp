#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/tracer/exr_source.h"
#include "runtime/tracer/height_map.h"
#include "runtime/tracer/image_io.h"
#include "runtime/tracer/png_source.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

constexpr double kMaxHeight = 1e6;

HeightMap read_exr_heights(std::string_view bytes, const std::string& name) {
  ExrSource source(bytes, name);
  const std::string channel = source.find_part({"Y"}) ? "Y" : "R";
  if (!source.find_part({channel})) source.fail_for_channels("Y or R must be there, at every pixel");
  const PixelWindow window = source.window();
  const bool is_whole = window == PixelWindow::whole(window.width, window.height);
  const auto pixels =
      static_cast<std::uint64_t>(window.columns()) * static_cast<std::uint64_t>(window.rows());
  require_picture_memory(name, window.width, window.height, sizeof(float), bytes.size(),
                         is_whole ? 0 : pixels * sizeof(float));
  std::vector<float> values;
  source.read({{{channel}, &values}});
  if (!is_whole) values = in_whole_picture(values, 1, window);
  return {window.width, window.height, std::move(values)};
}

// A height has no colour: three channels must be one number.
void require_grey(const PngNumbers& png, const std::string& name, std::size_t pixel) {
  const int r = png.at(3 * pixel), g = png.at(3 * pixel + 1), b = png.at(3 * pixel + 2);
  if (r == g && g == b) return;
  const auto width = static_cast<std::size_t>(png.width);
  throw Error(
      fmt::format("{}: pixel ({}, {}) from the top left has R, G, B {}, {}, {}; allowed for heights and "
                  "fields: grey, or three equal channels",
                  name, pixel % width, pixel / width, r, g, b));
}

HeightMap read_png_heights(std::string_view bytes, const std::string& name) {
  const PngNumbers png = parse_png(bytes, name, sizeof(float));
  HeightMap map{png.width, png.height, {}};
  const std::size_t pixels = static_cast<std::size_t>(png.width) * static_cast<std::size_t>(png.height);
  const auto channels = static_cast<std::size_t>(png.channels);
  map.values.reserve(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    if (channels == 3) require_grey(png, name, pixel);
    map.values.push_back(static_cast<float>(png.at(channels * pixel)) / static_cast<float>(png.largest()));
  }
  return map;
}

// The slice type is shared by reading and writing and hence not const; writing only reads through it.
Imf::Slice slice_of(const HeightMap& map) {
  char* base = reinterpret_cast<char*>(const_cast<float*>(map.values.data()));
  return {Imf::FLOAT, base, sizeof(float), sizeof(float) * static_cast<std::size_t>(map.width)};
}

std::string exr_bytes(const HeightMap& map) {
  Imf::Header header(map.width, map.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  Imf::FrameBuffer buffer;
  buffer.insert("Y", slice_of(map));
  Imf::StdOSStream stream;
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(buffer);
    file.writePixels(map.height);
  }  // the table of line offsets is written at the end
  return stream.str();
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

void require_sane(const HeightMap& map, const std::string& name) {
  const auto bad = std::find_if(map.values.begin(), map.values.end(),
                                [](float value) { return !(std::abs(value) <= kMaxHeight); });
  if (bad == map.values.end()) return;
  const long index = bad - map.values.begin();
  throw Error(fmt::format("{}: pixel ({}, {}) from the top left holds the height {:g}; allowed: {:g} to {:g}",
                          name, index % map.width, index / map.width, *bad, -kMaxHeight, kMaxHeight));
}

}  // namespace

void require_height_map_extension(const std::string& path) {
  const std::string type = extension(path);
  if (type != ".exr" && type != ".png")
    throw Error(fmt::format("{}: extension is '{}'; allowed for heights: .exr, .png", path, type));
}

HeightMap load_height_map(const std::string& path) {
  require_height_map_extension(path);
  return parse_height_map(read_file(path), path);
}

HeightMap parse_height_map(std::string_view bytes, const std::string& name) {
  if (!is_exr(bytes) && !is_png(bytes))
    throw Error(name + ": cannot read the height map: found no EXR or PNG; allowed: one of them");
  HeightMap map = is_exr(bytes) ? read_exr_heights(bytes, name) : read_png_heights(bytes, name);
  require_sane(map, name);
  return map;
}

void write_height_map(const std::string& path, const HeightMap& map) {
  require_height_map_extension(path);
  write_file_atomically(path, extension(path) == ".exr" ? exr_bytes(map) : png_bytes(map));
}

}  // namespace sunbeam
