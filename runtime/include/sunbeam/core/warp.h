// Maps from the unit square to directions, each with its density and its inverse beside it.
// Densities are per solid angle (1/sr); directions lie in the hemisphere z > 0.
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {

struct Point2 {
  double x = 0, y = 0;
};

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

inline Vec3 sample_cosine(const Point2& u) {
  return direction_from_cosine(std::sqrt(1 - u.x), 2 * kPi * u.y);
}
inline double cosine_pdf(double cos_theta) { return std::max(0.0, cos_theta) * kInvPi; }
inline Point2 invert_cosine(const Vec3& w) { return invert_power_cosine(1, w); }

// Uniform over the whole sphere.
inline Vec3 sample_sphere(const Point2& u) { return direction_from_cosine(1 - 2 * u.x, 2 * kPi * u.y); }
inline constexpr double sphere_pdf() { return kInvPi / 4; }

}  // namespace sunbeam
