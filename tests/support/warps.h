// More maps from the unit square to directions than the product needs, each with its density and its inverse.
#pragma once

#include "sunbeam/detail/warp.h"

namespace sunbeam {

// Directions with density proportional to cos^exponent. exponent = 1 is the cosine-weighted hemisphere.
inline Vec3 sample_power_cosine(double exponent, const Point2& u) {
  return direction_from_cosine(std::pow(1 - u.x, 1 / (exponent + 1)), 2 * kPi * u.y);
}
inline double power_cosine_pdf(double exponent, double cos_theta) {
  return cos_theta <= 0 ? 0 : (exponent + 1) / (2 * kPi) * std::pow(cos_theta, exponent);
}
inline Point2 invert_power_cosine(double exponent, const Vec3& w) {
  const double phi = std::atan2(w.y, w.x);
  return {1 - std::pow(w.z, exponent + 1), (phi < 0 ? phi + 2 * kPi : phi) / (2 * kPi)};
}

inline Point2 invert_cosine(const Vec3& w) { return invert_power_cosine(1, w); }

// Uniform over the whole sphere.
inline Vec3 sample_sphere(const Point2& u) { return direction_from_cosine(1 - 2 * u.x, 2 * kPi * u.y); }
inline constexpr double sphere_pdf() { return kInvPi / 4; }

}  // namespace sunbeam
