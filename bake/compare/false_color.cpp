#include "bake/compare/false_color.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sunbeam/core/error.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {
namespace {

// The map at eighths, sRGB; in between along straight lines.
constexpr std::array<Rgb, 9> kMagma = {{{0, 0, 4},
                                        {29, 17, 71},
                                        {81, 18, 124},
                                        {130, 38, 129},
                                        {182, 54, 121},
                                        {230, 81, 100},
                                        {251, 136, 97},
                                        {254, 194, 135},
                                        {252, 253, 191}}};
constexpr int kColors = 256;

Rgb magma(double t) {
  const double at = t * (kMagma.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), kMagma.size() - 2);
  const double f = at - static_cast<double>(k);
  return (1 - f) * kMagma[k] + f * kMagma[k + 1];
}

std::array<png_byte, 3 * kColors> palette() {
  std::array<png_byte, 3 * kColors> bytes;
  for (int k = 0; k < kColors; ++k)
    for (int channel = 0; channel < 3; ++channel)
      bytes[static_cast<std::size_t>(3 * k + channel)] =
          static_cast<png_byte>(std::lround(magma(k / (kColors - 1.0))[channel]));
  return bytes;
}

}  // namespace

std::string magma_png(const std::vector<double>& values, int width, int height) {
  std::vector<png_byte> indices;
  for (const double value : values)
    indices.push_back(static_cast<png_byte>(std::lround((kColors - 1) * std::clamp(value, 0.0, 1.0))));
  const auto colors = palette();
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = PNG_FORMAT_RGB_COLORMAP;
  png.colormap_entries = kColors;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, indices.data(), 0, colors.data()))
    throw Error(fmt::format("cannot encode the picture as PNG: {}", png.message));
  bytes.resize(size);
  return bytes;
}

}  // namespace sunbeam
