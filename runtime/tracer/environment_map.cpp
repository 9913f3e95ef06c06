#include "runtime/tracer/environment_map.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/tracer/image_io.h"
#include "runtime/tracer/radiance_hdr.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

// What Environment keeps of a pixel to draw directions.
constexpr std::uint64_t kBytesOfDistribution = sizeof(double);

// To the display window, if that is another one.
void place(ExrImage& exr, const std::string& name, std::uint64_t file_bytes, EnvironmentMap& result) {
  const PixelWindow& window = *exr.window;
  const bool is_whole = window == PixelWindow::whole(window.width, window.height);
  const std::uint64_t bytes_beside = is_whole ? 0 : exr.mean.rgb.size() * sizeof(float);
  require_picture_memory(name, window.width, window.height, 3 * sizeof(float) + kBytesOfDistribution,
                         file_bytes, bytes_beside);
  if (is_whole) {
    result.map = std::move(exr.mean);
    return;
  }
  result.map.width = window.width;
  result.map.height = window.height;
  result.map.rgb = in_whole_picture(exr.mean.rgb, 3, window);
  result.warnings.push_back(fmt::format(
      "{}: the data window is not the display window of {} x {}: pixels without data count as black, "
      "pixels beyond are cut off",
      name, window.width, window.height));
}

// Photographs have slightly negative pixels from their filters, and so have spectral colours outside of
// Rec.709.
void clamp_negative(const std::string& name, EnvironmentMap& result) {
  std::size_t pixels = 0;
  float lowest = 0;
  for (std::size_t i = 0; i < result.map.rgb.size(); i += 3) {
    float* pixel = &result.map.rgb[i];
    const float least = std::min({pixel[0], pixel[1], pixel[2]});
    if (!(least < 0)) continue;
    ++pixels;
    lowest = std::min(lowest, least);
    for (int channel = 0; channel < 3; ++channel) pixel[channel] = std::max(pixel[channel], 0.0f);
  }
  if (pixels > 0)
    result.warnings.push_back(
        fmt::format("{}: {} of {} pixels have negative components, which count as 0 (lowest {:g})", name,
                    pixels, result.map.rgb.size() / 3, lowest));
}

}  // namespace

EnvironmentMap load_environment_map(const std::string& path) {
  return parse_environment_map(read_file(path), path);
}

EnvironmentMap parse_environment_map(std::string_view bytes, const std::string& name) {
  EnvironmentMap result;
  if (is_radiance_hdr(bytes)) {
    result.map = parse_radiance_hdr(bytes, name, kBytesOfDistribution);
  } else {
    if (!is_exr(bytes))
      throw Error(name +
                  ": cannot read the environment: found neither EXR nor Radiance; allowed: one of them");
    ExrImage exr = parse_exr(bytes, name, ExrChannels::mean, kBytesOfDistribution);
    if (exr.is_cube_map) throw Error(name + ": the attribute envmap says cube map; allowed: latlong");
    place(exr, name, bytes.size(), result);
  }
  clamp_negative(name, result);
  return result;
}

}  // namespace sunbeam
