#include "sunbeam/core/color_space.h"

#include <array>
#include <string>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

struct Chromaticity {
  double x, y;
};
struct SpaceDefinition {
  Chromaticity red, green, blue, white;
};

constexpr Chromaticity kD65 = {0.3127, 0.3290};

// Of a space with primaries; xyz has those of none, and its white.
constexpr SpaceDefinition definition(ColorSpace space) {
  if (space == ColorSpace::acescg)
    return {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};
  if (space == ColorSpace::rec2020) return {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65};
  return {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65};
}

// Tristimulus values with Y = 1.
constexpr Vec3 tristimulus(const Chromaticity& c) { return {c.x / c.y, 1, (1 - c.x - c.y) / c.y}; }

ColorMatrix from_columns(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}};
}

ColorMatrix diagonal(const Vec3& d) { return {{{d.x, 0, 0}, {0, d.y, 0}, {0, 0, d.z}}}; }

// XYZ to the sharpened cone responses of Bradford's transform.
constexpr ColorMatrix kBradford = {
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

constexpr std::array<std::string_view, 4> kNames = {"rec709", "acescg", "rec2020", "xyz"};  // as ColorSpace

}  // namespace

ColorMatrix ColorMatrix::operator*(const ColorMatrix& other) const {
  ColorMatrix product;
  for (int i = 0; i < 3; ++i)
    product.row[i] = row[i].x * other.row[0] + row[i].y * other.row[1] + row[i].z * other.row[2];
  return product;
}

ColorMatrix inverse(const ColorMatrix& matrix) {
  const Vec3 *a = matrix.row, bc = cross(a[1], a[2]), ca = cross(a[2], a[0]), ab = cross(a[0], a[1]);
  const double determinant = dot(a[0], bc);
  return from_columns(bc / determinant, ca / determinant, ab / determinant);
}

std::string_view to_string(ColorSpace space) { return kNames[static_cast<std::size_t>(space)]; }

ColorSpace color_space_from(std::string_view name) {
  std::string allowed;
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    if (name == kNames[k]) return static_cast<ColorSpace>(k);
    allowed += (k > 0 ? ", " : "") + std::string(kNames[k]);
  }
  throw Error("found '" + shortened(name) + "'; allowed: " + allowed);
}

Vec3 white(ColorSpace space) { return tristimulus(definition(space).white); }

ColorMatrix rgb_to_xyz(ColorSpace space) {
  if (space == ColorSpace::xyz) return diagonal({1, 1, 1});
  const SpaceDefinition d = definition(space);
  const ColorMatrix primaries = from_columns(tristimulus(d.red), tristimulus(d.green), tristimulus(d.blue));
  return primaries * diagonal(inverse(primaries) * white(space));
}

ColorMatrix bradford(const Vec3& from, const Vec3& to) {
  const Vec3 a = kBradford * from, b = kBradford * to;
  return inverse(kBradford) * diagonal({b.x / a.x, b.y / a.y, b.z / a.z}) * kBradford;
}

ColorMatrix xyz_to_rgb(const Vec3& illuminant_white, ColorSpace space) {
  return inverse(rgb_to_xyz(space)) * bradford(illuminant_white, white(space));
}

ColorMatrix rgb_to_rgb(ColorSpace from, ColorSpace to) {
  if (from == to) return diagonal({1, 1, 1});
  return inverse(rgb_to_xyz(to)) * bradford(white(from), white(to)) * rgb_to_xyz(from);
}

double luminance(const Rgb& color, ColorSpace space) {
  static const std::array<Vec3, 4> kRows = {
      rgb_to_xyz(ColorSpace::rec709).row[1], rgb_to_xyz(ColorSpace::acescg).row[1],
      rgb_to_xyz(ColorSpace::rec2020).row[1], rgb_to_xyz(ColorSpace::xyz).row[1]};
  return dot(kRows[static_cast<std::size_t>(space)], {color.r, color.g, color.b});
}

GamutClip clip_negative(const Rgb& color, ColorSpace space) {
  GamutClip result;
  result.clipped = transform(color, [](double c) { return c < 0 ? 0 : c; });
  result.added = result.clipped - color;
  result.luminance_added = luminance(result.added, space);
  return result;
}

Rgb ClipAccount::clip(const Rgb& color, ColorSpace space) {
  const GamutClip result = clip_negative(color, space);
  ++colors;
  if (!is_black(result.added)) ++clipped;
  lowest = std::min({lowest, color.r, color.g, color.b});
  luminance += sunbeam::luminance(color, space);
  luminance_added += result.luminance_added;
  return result.clipped;
}

}  // namespace v1
}  // namespace sunbeam
