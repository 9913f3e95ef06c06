// Quadrature of the tests: Gauss-Legendre panels on an interval, midpoints on the hemisphere.
#pragma once

#include <array>

#include "sunbeam/core/vec.h"

namespace sunbeam::test {

// Int_a^b f(x) dx, eight Gauss-Legendre points on each of `panels` equal panels (nodes: Abramowitz and
// Stegun, table 25.4).
template <class F>
double integrate(double a, double b, int panels, F f) {
  constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                        0.9602898564975363};
  constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                          0.1012285362903763};
  const double half = (b - a) / (2 * panels);
  double sum = 0;
  for (int p = 0; p < panels; ++p) {
    const double centre = a + (2 * p + 1) * half;
    for (std::size_t i = 0; i < kNode.size(); ++i)
      sum += kWeight[i] * (f(centre - half * kNode[i]) + f(centre + half * kNode[i]));
  }
  return sum * half;
}

// Int f(w) dw over the upper hemisphere: midpoints in both angles, dw = sin dtheta dphi.
template <class F>
double integrate_hemisphere(int polar, int azimuthal, F f) {
  double sum = 0;
  for (int i = 0; i < polar; ++i) {
    const double theta = (i + 0.5) / polar * kPi / 2;
    for (int j = 0; j < azimuthal; ++j)
      sum += std::sin(theta) * f(spherical_direction(theta, 2 * kPi * (j + 0.5) / azimuthal));
  }
  return sum * kPi * kPi / (static_cast<double>(polar) * azimuthal);
}

// Int f(h) dh over microfacet normals: midpoints in x of tan(theta) = scale x / (1 - x), which spreads a lobe
// of width `scale` over the unit interval; dh = sin dtheta dphi, dtheta = cos^2 scale / (1 - x)^2 dx.
template <class F>
double integrate_normals(double scale, int polar, int azimuthal, F f) {
  double sum = 0;
  for (int i = 0; i < polar; ++i) {
    const double x = (i + 0.5) / polar;
    const double theta = std::atan(scale * x / (1 - x));
    const double jacobian = std::sin(theta) * square(std::cos(theta)) * scale / square(1 - x);
    for (int j = 0; j < azimuthal; ++j)
      sum += jacobian * f(spherical_direction(theta, 2 * kPi * (j + 0.5) / azimuthal));
  }
  return sum * 2 * kPi / (static_cast<double>(polar) * azimuthal);
}

}  // namespace sunbeam::test
