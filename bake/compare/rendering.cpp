#include "bake/compare/rendering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "runtime/tracer/png_source.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

// What is made of a pixel: what is displayed, as floats, and half of the map of FLIP.
constexpr std::uint64_t kBytesOfComparison = 3 * sizeof(float) + sizeof(double) / 2;

void require_variance(const std::string& name, const Image& variance) {
  const auto bad = std::find_if(variance.rgb.begin(), variance.rgb.end(),
                                [](float v) { return !std::isfinite(v) || v < 0; });
  if (bad == variance.rgb.end()) return;
  const long index = bad - variance.rgb.begin();
  throw Error(
      fmt::format("{}: channel variance.{} of pixel ({}, {}) from the top left is {}; allowed: finite "
                  "numbers from 0",
                  name, "RGB"[index % 3], index / 3 % variance.width, index / 3 / variance.width, *bad));
}

double linear_from_srgb(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }

// sRGB and a colour profile stand above gAMA and cHRM, as the specification of PNG has it.
void require_srgb(const std::string& name, const PngNumbers& png) {
  constexpr double kSrgbGamma = 1 / 2.2, kRounding = 0.01;
  if (png.is_srgb || png.has_profile) return;
  if (png.gamma && std::abs(*png.gamma - kSrgbGamma) > kRounding)
    throw Error(
        fmt::format("{}: gAMA is {:g}; allowed: {:.5f}, which is nearly sRGB", name, *png.gamma, kSrgbGamma));
  if (png.chromaticities && !is_rec709(*png.chromaticities))
    throw Error(fmt::format("{}: cHRM states other primaries than those of sRGB; allowed: those", name));
}

Rendering read_png(std::string_view bytes, const std::string& name) {
  const PngNumbers png = parse_png(bytes, name, 3 * sizeof(float) + kBytesOfComparison);
  require_srgb(name, png);
  Rendering result{.picture = {}, .is_displayed = true, .note = {}};
  result.note = name + ": sRGB is decoded to linear light";
  if (png.has_profile) result.note += "; its colour profile is not read";
  Image& image = result.picture.mean;
  image = Image(png.width, png.height);
  std::vector<float> linear;
  for (int number = 0; number <= png.largest(); ++number)
    linear.push_back(static_cast<float>(linear_from_srgb(double{1} * number / png.largest())));
  const bool is_grey = png.channels == 1;
  for (std::size_t k = 0; k < image.rgb.size(); ++k)
    image.rgb[k] = linear[static_cast<std::size_t>(png.at(is_grey ? k / 3 : k))];
  result.picture.window = PixelWindow::whole(png.width, png.height);
  return result;
}

}  // namespace

Rendering read_rendering(const std::string& path) { return parse_rendering(read_file(path), path); }

Rendering parse_rendering(std::string_view bytes, const std::string& name) {
  if (is_png(bytes)) return read_png(bytes, name);
  if (!is_exr(bytes))
    throw Error(name + ": cannot read the picture: found neither EXR nor PNG; allowed: one of them");
  Rendering result;
  result.picture = parse_exr(bytes, name, ExrChannels::mean_and_variance, kBytesOfComparison);
  require_variance(name, result.picture.variance);
  if (result.picture.is_converted)
    result.note = name + ": the chromaticities of its header are converted to Rec.709, but no variance";
  return result;
}

}  // namespace sunbeam
