// This file takes means of GGX facets (sunbeam/detail/ggx.h) over all turns of a facet about the macro
// normal, with directions turned along with it. They are all that a film is to light whose azimuth nobody
// knows.
#pragma once

#include <vector>

#include "sunbeam/detail/ggx.h"

namespace sunbeam {

class FacetTurns {
 public:
  explicit FacetTurns(const Roughness& roughness) : roughness_(roughness), ggx_(roughness) {
    const int count = count_of(roughness);
    for (int k = 0; k < count; ++k) azimuths_.push_back(kPi * k / count);
  }

  // Describes one azimuth of a facet's normal by cosine and sine of twice the angle, and by D(h) over the
  // number of azimuths.
  struct Turn {
    double cos_twice, sin_twice, density;
  };

  // Returns the turns of facets tilted by `theta`.
  std::vector<Turn> at(double theta) const {
    std::vector<Turn> turns;
    for (const double azimuth : azimuths_)
      turns.push_back({std::cos(2 * azimuth), std::sin(2 * azimuth),
                       ggx_.d(spherical_direction(theta, azimuth)) / static_cast<double>(azimuths_.size())});
    return turns;
  }

  // Returns the mean of D(h) times the height-correlated masking of a direction and its partner, if that is
  // masked at all.
  double masked(const std::vector<Turn>& turns, const Vec3& w, const Vec3* partner) const {
    const Lambda here(roughness_, w), there(roughness_, partner ? *partner : w);
    double sum = 0;
    for (const Turn& turn : turns) sum += turn.density / (1 + here.at(turn) + (partner ? there.at(turn) : 0));
    return sum;
  }

 private:
  // Returns how many even azimuths average functions of GGX's slopes, whose Fourier modes shrink by (v - u) /
  // (v + u).
  static int count_of(const Roughness& roughness) {
    constexpr double kError = 1e-8;  // share of the anisotropy that is left out
    const double shrink = std::abs(roughness.u - roughness.v) / (roughness.u + roughness.v);
    return shrink == 0 ? 1 : 2 + static_cast<int>(std::log(kError) / std::log(shrink));
  }

  // Evaluates Smith's Lambda of a direction turned to azimuths about the macro normal along with the facet it
  // meets:
  //   2 tan^2 (u^2 cos^2 + v^2 sin^2) = tan^2 (u^2 + v^2) + (u^2 - v^2) (tan^2 cos(2 phi)).
  struct Lambda {
    double even, cosine, sine;

    Lambda(const Roughness& r, const Vec3& w) {
      const double per = 0.5 / square(w.z), difference = (square(r.u) - square(r.v)) * per;
      even = 1 + (square(r.u) + square(r.v)) * per * (square(w.x) + square(w.y));
      cosine = difference * (square(w.x) - square(w.y));
      sine = -2 * difference * w.x * w.y;
    }
    double at(const Turn& turn) const {
      return (std::sqrt(even + cosine * turn.cos_twice + sine * turn.sin_twice) - 1) / 2;
    }
  };

  Roughness roughness_;
  Ggx ggx_;
  std::vector<double> azimuths_;  // even over half a turn; one if the film is isotropic
};

}  // namespace sunbeam
