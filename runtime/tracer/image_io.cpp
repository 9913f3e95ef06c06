#include "runtime/tracer/image_io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <png.h>

#include <array>
#include <cmath>
#include <exception>

#include "sunbeam/core/error.h"
#include "sunbeam/core/file.h"

namespace sunbeam {
namespace {

constexpr std::array<const char*, 3> kMeanChannels = {"R", "G", "B"};
constexpr std::array<const char*, 3> kVarianceChannels = {"variance.R", "variance.G", "variance.B"};
// A header may claim any size; nothing in this program needs more.
constexpr long kMaxPixels = 1L << 28;

// `min` is the corner of the data window: OpenEXR addresses pixels by absolute coordinates.
void insert_slices(Imf::FrameBuffer& buffer, const std::array<const char*, 3>& names, const Image& image,
                   const Imath::V2i& min) {
  const std::size_t pixel = 3 * sizeof(float);
  const std::size_t row = pixel * static_cast<std::size_t>(image.width);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    // The slice type is shared by reading and writing and hence not const; writing only reads through it.
    float* base = const_cast<float*>(image.rgb.data()) + channel;
    char* origin = reinterpret_cast<char*>(base) - static_cast<std::ptrdiff_t>(pixel) * min.x -
                   static_cast<std::ptrdiff_t>(row) * min.y;
    buffer.insert(names[channel], Imf::Slice(Imf::FLOAT, origin, pixel, row));
  }
}

bool has_channels(const Imf::Header& header, const std::array<const char*, 3>& names) {
  for (const char* name : names)
    if (!header.channels().findChannel(name)) return false;
  return true;
}

std::string channel_names(const Imf::Header& header) {
  std::string names;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
    names += (names.empty() ? "" : ", ") + std::string(it.name());
  return names.empty() ? "none" : names;
}

std::string exr_bytes(const ExrImage& image) {
  Imf::Header header(image.mean.width, image.mean.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::addChromaticities(header, Imf::Chromaticities());  // the defaults are Rec.709 with D65
  for (const auto& [name, value] : image.attributes) header.insert(name, Imf::StringAttribute(value));
  Imf::FrameBuffer buffer;
  insert_slices(buffer, kMeanChannels, image.mean, {0, 0});
  if (!image.variance.empty()) insert_slices(buffer, kVarianceChannels, image.variance, {0, 0});
  for (auto it = buffer.begin(); it != buffer.end(); ++it)
    header.channels().insert(it.name(), Imf::Channel(Imf::FLOAT));
  Imf::StdOSStream stream;
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(buffer);
    file.writePixels(image.mean.height);
  }  // the table of line offsets is written at the end
  return stream.str();
}

ExrImage read_channels(const std::string& path) {
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  const Imath::Box2i window = header.dataWindow();
  const long width = long{window.max.x} - window.min.x + 1;
  const long height = long{window.max.y} - window.min.y + 1;
  if (width > kMaxPixels || height > kMaxPixels || width * height > kMaxPixels)
    throw Error(fmt::format("found {} x {} pixels; allowed: {} in all", width, height, kMaxPixels));
  if (!has_channels(header, kMeanChannels))
    throw Error(fmt::format("found channels {}; allowed: R, G and B must be there", channel_names(header)));

  ExrImage image;
  image.mean = Image(static_cast<int>(width), static_cast<int>(height));
  Imf::FrameBuffer buffer;
  insert_slices(buffer, kMeanChannels, image.mean, window.min);
  if (has_channels(header, kVarianceChannels)) {
    image.variance = Image(image.mean.width, image.mean.height);
    insert_slices(buffer, kVarianceChannels, image.variance, window.min);
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  for (auto it = header.begin(); it != header.end(); ++it)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
      image.attributes[it.name()] = text->value();
  return image;
}

void require_pixels(const std::string& path, const Image& image) {
  if (image.empty())
    throw Error(fmt::format("{}: cannot write a picture of {} x {} pixels", path, image.width, image.height));
}

// Identity up to kKnee, then an exponential approach to 1 with a continuous slope.
double shoulder(double x) {
  constexpr double kKnee = 0.5;
  return x <= kKnee ? std::max(x, 0.0) : 1 - (1 - kKnee) * std::exp(-(x - kKnee) / (1 - kKnee));
}

png_byte srgb_byte(double linear) {
  const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<png_byte>(std::lround(255 * std::clamp(encoded, 0.0, 1.0)));
}

std::vector<png_byte> srgb_pixels(const Image& image, ClipAccount& account) {
  std::vector<png_byte> bytes;
  bytes.reserve(image.rgb.size());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rgb color = display_color(account.clip(image.get(x, y), ColorSpace::rec709));
      for (int channel = 0; channel < 3; ++channel) bytes.push_back(srgb_byte(color[channel]));
    }
  return bytes;
}

}  // namespace

void write_exr(const std::string& path, const ExrImage& image) {
  require_pixels(path, image.mean);
  const bool same_size =
      image.variance.width == image.mean.width && image.variance.height == image.mean.height;
  if (!image.variance.empty() && !same_size)
    throw Error(fmt::format("{}: the variance has {} x {} pixels; allowed: those of the mean, {} x {}", path,
                            image.variance.width, image.variance.height, image.mean.width,
                            image.mean.height));
  std::string bytes;
  try {
    bytes = exr_bytes(image);
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: cannot write the EXR file: {}", path, error.what()));
  }
  write_file_atomically(path, bytes);
}

ExrImage read_exr(const std::string& path) {
  try {
    return read_channels(path);
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: cannot read the EXR file: {}", path, error.what()));
  }
}

std::string png_bytes(const Image& image, ClipAccount& account) {
  const std::vector<png_byte> pixels = srgb_pixels(image, account);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels.data(), 0, nullptr))
    throw Error(fmt::format("cannot encode the picture as PNG: {}", png.message));
  bytes.resize(size);
  return bytes;
}

ClipAccount write_png(const std::string& path, const Image& image) {
  require_pixels(path, image);
  ClipAccount account;
  write_file_atomically(path, png_bytes(image, account));
  return account;
}

Rgb display_color(const Rgb& scene_linear) {
  const double peak = max_component(scene_linear);
  if (peak <= 0) return {};
  const Rgb same_hue = scene_linear * (shoulder(peak) / peak);
  return 0.5 *
         (transform(same_hue, [](double x) { return std::max(x, 0.0); }) + transform(scene_linear, shoulder));
}

}  // namespace sunbeam
