#include "runtime/tracer/chromaticities.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr Chromaticities kRec709 = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};

// The primaries that make R, G and B the tristimulus values X, Y and Z.
constexpr Chromaticities kXyz = {{1, 0}, {0, 1}, {0, 0}, {1 / 3.0, 1 / 3.0}};

std::array<double, 8> numbers(const Chromaticities& c) {
  return {c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
}

bool is_nearly(const Chromaticities& a, const Chromaticities& b) {
  constexpr double kRounding = 1e-4;
  const auto x = numbers(a), y = numbers(b);
  return std::equal(x.begin(), x.end(), y.begin(),
                    [](double p, double q) { return std::abs(p - q) <= kRounding; });
}

Vec3 tristimulus(const Point2& p) { return {p.x, p.y, 1 - p.x - p.y}; }

ColorMatrix from_columns(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}};
}

[[noreturn]] void refuse(const Chromaticities& c) {
  constexpr const char* kFound =
      "has chromaticities ({:g}, {:g}), ({:g}, {:g}), ({:g}, {:g}) and white ({:g}, {:g})";
  const std::string found =
      fmt::format(kFound, c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y);
  throw Error(found + "; allowed: a triangle around its white");
}

void require_color_space(const Chromaticities& space) {
  constexpr double kMost = 100;  // imaginary primaries of cameras stay below 10
  for (const double number : numbers(space))
    if (!(std::abs(number) <= kMost)) refuse(space);
  constexpr double kLeastArea = 1e-4, kLeastWhite = 1e-3;
  const Vec3 red = tristimulus(space.red), green = tristimulus(space.green), blue = tristimulus(space.blue);
  const double area = dot(cross(red, green), blue);
  if (std::abs(area) < kLeastArea || space.white.y < kLeastWhite) refuse(space);
  const Vec3 weights = inverse(from_columns(red, green, blue)) * tristimulus(space.white);
  for (const double weight : {weights.x, weights.y, weights.z})
    if (!(weight > 0)) refuse(space);
}

}  // namespace

bool is_rec709(const Chromaticities& space) { return is_nearly(space, kRec709); }

ColorMatrix to_rec709(const Chromaticities& space) {
  require_color_space(space);
  if (is_nearly(space, kXyz)) return inverse(rgb_to_xyz(ColorSpace::rec709));
  const ColorMatrix primaries =
      from_columns(tristimulus(space.red), tristimulus(space.green), tristimulus(space.blue));
  const Vec3 white = tristimulus(space.white) / space.white.y;
  const Vec3 weights = inverse(primaries) * white;
  const ColorMatrix to_xyz =
      primaries * ColorMatrix{{{weights.x, 0, 0}, {0, weights.y, 0}, {0, 0, weights.z}}};
  return xyz_to_rgb(white, ColorSpace::rec709) * to_xyz;
}

void convert_to_rec709(Image& image, const Chromaticities& space) {
  if (is_rec709(space)) return;
  const ColorMatrix matrix = to_rec709(space);
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    const Rgb converted = matrix * image.at(i / 3);
    for (int channel = 0; channel < 3; ++channel)
      image.rgb[i + static_cast<std::size_t>(channel)] = static_cast<float>(converted[channel]);
  }
}

}  // namespace sunbeam
