#include "runtime/tracer/image_io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <span>
#include <string_view>

#include "runtime/tracer/chromaticities.h"
#include "runtime/tracer/exr_source.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

constexpr std::array<const char*, 3> kMeanChannels = {"R", "G", "B"};
constexpr std::array<const char*, 3> kVarianceChannels = {"variance.R", "variance.G", "variance.B"};

std::vector<std::string> names(const std::array<const char*, 3>& channels) {
  return {channels.begin(), channels.end()};
}

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

void insert_slice(Imf::FrameBuffer& buffer, const std::string& name, const std::vector<float>& values,
                  int width, const Imath::V2i& min) {
  const std::size_t row = sizeof(float) * static_cast<std::size_t>(width);
  char* origin = reinterpret_cast<char*>(const_cast<float*>(values.data())) -
                 static_cast<std::ptrdiff_t>(sizeof(float)) * min.x -
                 static_cast<std::ptrdiff_t>(row) * min.y;
  buffer.insert(name, Imf::Slice(Imf::FLOAT, origin, sizeof(float), row));
}

std::string exr_bytes(const ExrImage& image) {
  const PixelWindow window = image.window.value_or(PixelWindow::whole(image.mean.width, image.mean.height));
  const Imath::V2i min(window.x0, window.y0);
  const Imath::Box2i whole({0, 0}, {window.width - 1, window.height - 1});
  const Imath::Box2i part(min, {window.x1 - 1, window.y1 - 1});
  Imf::Header header(whole, part);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::addChromaticities(header, Imf::Chromaticities());  // the defaults are Rec.709 with D65
  for (const auto& [name, value] : image.attributes) header.insert(name, Imf::StringAttribute(value));
  Imf::FrameBuffer buffer;
  insert_slices(buffer, kMeanChannels, image.mean, min);
  if (!image.variance.empty()) insert_slices(buffer, kVarianceChannels, image.variance, min);
  for (const auto& [name, values] : image.layers) insert_slice(buffer, name, values, image.mean.width, min);
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

// A file of luminance alone is grey.
std::vector<float> grey_pixels(const std::vector<float>& luminance) {
  std::vector<float> rgb;
  rgb.reserve(3 * luminance.size());
  for (const float value : luminance) rgb.insert(rgb.end(), 3, value);
  return rgb;
}

// Of a file without R, G and B.
std::vector<float> read_luminance(ExrSource& source, std::uint64_t more_bytes_per_pixel) {
  if (source.find_part({"Y", "RY", "BY"}, true)) {
    source.require_memory(3 * sizeof(float) + more_bytes_per_pixel);
    return source.read_luminance_chroma();
  }
  if (!source.find_part({"Y"})) source.fail_for_channels("R, G and B must be there, or Y, at every pixel");
  source.require_memory(4 * sizeof(float) + more_bytes_per_pixel);
  std::vector<float> luminance;
  source.read({{{"Y"}, &luminance}});
  return grey_pixels(luminance);
}

// What is read of a part with R, G and B beside them.
std::vector<ExrRequest> requests(const ExrSource& source, ExrChannels channels, ExrImage& image) {
  std::vector<ExrRequest> wanted = {{names(kMeanChannels), &image.mean.rgb}};
  if (channels == ExrChannels::mean) return wanted;
  const auto is_there = [&](const std::string& name) { return source.has_channel(name); };
  if (std::all_of(kVarianceChannels.begin(), kVarianceChannels.end(), is_there))
    wanted.push_back({names(kVarianceChannels), &image.variance.rgb});
  if (channels == ExrChannels::mean_and_variance) return wanted;
  const Imf::ChannelList& list = source.header().channels();
  for (auto it = list.begin(); it != list.end(); ++it) {
    const std::string name = it.name();
    const bool is_asked_for = std::any_of(wanted.begin(), wanted.end(), [&](const ExrRequest& request) {
      return std::find(request.channels.begin(), request.channels.end(), name) != request.channels.end();
    });
    if (!is_asked_for && is_there(name)) wanted.push_back({{name}, &image.layers[name]});
  }
  return wanted;
}

// Chromaticities of the header tell what R, G and B mean. How noise of several channels adds up is not known,
// so converted pictures have no variance.
void convert(const ExrSource& source, ExrImage& image) {
  if (!Imf::hasChromaticities(source.header())) return;
  const Imf::Chromaticities& stated = Imf::chromaticities(source.header());
  const auto point = [](const Imath::V2f& p) { return Point2{p.x, p.y}; };
  const Chromaticities space{point(stated.red), point(stated.green), point(stated.blue), point(stated.white)};
  if (is_rec709(space)) return;
  try {
    convert_to_rec709(image.mean, space);
  } catch (const Error& error) {
    source.fail(error.what());
  }
  image.variance = {};
  image.is_converted = true;
}

void require_pixels(const std::string& path, const Image& image) {
  if (image.empty())
    throw Error(fmt::format("{}: cannot write a picture of {} x {} pixels", path, image.width, image.height));
}

void require_finite(const std::string& path, std::span<const float> values, const std::string& what) {
  const auto at = std::ranges::find_if(values, [](float value) { return !std::isfinite(value); });
  if (at != values.end())
    throw Error(
        fmt::format("{}: cannot write the picture: {} holds {}; allowed: finite numbers", path, what, *at));
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

void insert_layers(ExrImage& exr, const std::string& name, const std::string& axes, const Image& image) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto& layer = exr.layers[name + "." + axes[axis]];
    for (std::size_t i = axis; i < image.rgb.size(); i += 3) layer.push_back(image.rgb[i]);
  }
}

Image extract_layers(const ExrImage& exr, const std::string& name, const std::string& axes) {
  Image image(exr.mean.width, exr.mean.height);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto layer = exr.layers.find(name + "." + axes[axis]);
    if (layer == exr.layers.end()) return {};
    for (std::size_t i = 0; i < layer->second.size(); ++i) image.rgb[3 * i + axis] = layer->second[i];
  }
  return image;
}

void write_exr(const std::string& path, const ExrImage& image) {
  require_pixels(path, image.mean);
  const bool same_size =
      image.variance.width == image.mean.width && image.variance.height == image.mean.height;
  if (!image.variance.empty() && !same_size)
    throw Error(fmt::format("{}: the variance has {} x {} pixels; allowed: those of the mean, {} x {}", path,
                            image.variance.width, image.variance.height, image.mean.width,
                            image.mean.height));
  require_finite(path, image.mean.rgb, "R, G or B");
  require_finite(path, image.variance.rgb, "the variance");
  for (const auto& [name, values] : image.layers) require_finite(path, values, "channel " + name);
  std::string bytes;
  try {
    bytes = exr_bytes(image);
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: cannot write the EXR file: {}", path, error.what()));
  }
  write_file_atomically(path, bytes);
}

bool is_exr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }

ExrImage read_exr(const std::string& path, ExrChannels channels) {
  return parse_exr(read_file(path), path, channels);
}

ExrImage parse_exr(std::string_view bytes, const std::string& name, ExrChannels channels,
                   std::uint64_t more_bytes_per_pixel) {
  ExrSource source(bytes, name);
  ExrImage image;
  if (source.find_part(names(kMeanChannels))) {
    source.require_memory(3 * sizeof(float) + more_bytes_per_pixel);
    source.read(requests(source, channels, image));
    for (auto it = source.header().begin(); it != source.header().end(); ++it)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
        image.attributes[it.name()] = text->value();
  } else {
    image.mean.rgb = read_luminance(source, more_bytes_per_pixel);
  }
  image.window = source.window();
  for (Image* part : {&image.mean, &image.variance})
    if (!part->empty()) part->width = image.window->columns(), part->height = image.window->rows();
  if (image.mean.empty()) source.fail("it has no pixels");
  if (Imf::hasEnvmap(source.header()))
    image.is_cube_map = Imf::envmap(source.header()) != Imf::ENVMAP_LATLONG;
  convert(source, image);
  require_finite(name, image.mean);
  return image;
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
  require_finite(path, image.rgb, "it");
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
