// This file treats GGX facets (sunbeam/detail/ggx.h) as a medium that light wanders in. It is Smith's
// microsurface after Heitz et al. 2016, position-free as in Bitterli and d'Eon 2022.
//
// Of the height only C, the share of the microsurface below it, matters. With depth = -ln C (0 above
// everything) a microsurface is a homogeneous half-space: light travelling along x meets facets at
//     rate(x) = area(x) / |x.z|  per unit of depth,   area(x) = (sqrt(z^2 + u^2 x^2 + v^2 y^2) - z) / 2,
// Smith's Lambda for light on its way up and 1 + Lambda on its way down, whatever the height distribution.
// The facets it meets are the visible normals D_vis(h; -x) = max(0, -x.h) D(h) / area(x).
//
// Each side of the film sees such a half-space in a frame of its own: "outside" is the local frame, "inside"
// its point reflection, so that in both a direction with z > 0 leads away from the facets. Light that passes
// a facet changes sides: depths become e^-inside + e^-outside = 1, directions turn round.
#pragma once

#include "sunbeam/core/rng.h"
#include "sunbeam/detail/ggx.h"
#include "sunbeam/detail/side.h"

namespace sunbeam::walk {

using sunbeam::opposite;
using sunbeam::Side;

// Says where light is: between two facets, or about to meet one at this depth. Directions are in the frame of
// the side.
struct Place {
  Side side;
  Vec3 travel;
  double depth;
  bool is_entry = false;  // the first facet of a walk from outside that sample() would make

  bool leads_away() const { return travel.z > 0; }
};

inline double depth_from_other_side(double depth) { return -std::log(-std::expm1(-std::max(depth, 1e-300))); }

// Finds the counterpart of `w` beyond a facet, on the same side of its normal `h` as w; ratio = index of w's
// medium over the other's. Returns false under total reflection.
inline bool refract(const Vec3& w, const Vec3& h, double ratio, Vec3& beyond) {
  const double cosine = dot(w, h);
  const double beyond2 = 1 - square(ratio) * (1 - square(cosine));
  if (beyond2 <= 0) return false;
  beyond = normalize(ratio * w + (std::sqrt(beyond2) - ratio * cosine) * h);
  return true;
}

class Microsurface {
 public:
  explicit Microsurface(const Roughness& roughness)
      : ggx_(roughness), u2_(square(roughness.u)), v2_(square(roughness.v)) {}

  const Ggx& ggx() const { return ggx_; }

  double area(const Vec3& x) const {
    const double across2 = u2_ * x.x * x.x + v2_ * x.y * x.y;
    const double length = std::sqrt(x.z * x.z + across2);
    return 0.5 * (x.z > 0 ? across2 / (length + x.z) : length - x.z);
  }
  double rate(const Vec3& x) const { return area(x) / std::max(std::abs(x.z), 1e-12); }

  // Returns the chance to leave from here without meeting another facet.
  double escape_chance(const Place& at) const {
    return at.leads_away() ? std::exp(-rate(at.travel) * at.depth) : 0;
  }

  // Draws the normal of a facet that light travelling along x meets.
  Vec3 sample_facet(const Vec3& x, Rng& rng) const {
    return ggx_.sample_visible(-x, {rng.uniform(), rng.uniform()});
  }

  // Returns the density of sample_facet(), 1/sr.
  double visible_density(const Vec3& x, const Vec3& h) const {
    return std::max(0.0, -dot(x, h)) * ggx_.d(h) / area(x);
  }

  // Flies on to the next facet, which is certain on the way down. Returns false if light on its way up
  // escapes.
  bool fly(Place& at, Rng& rng) const {
    const double step = -std::log(1 - rng.uniform()) / rate(at.travel);
    at.depth += at.leads_away() ? -step : step;
    return at.depth > 0;
  }
  // Does the same for light that must not escape: the caller has weighed it with 1 - escape_chance.
  void fly_back(Place& at, Rng& rng) const {
    if (!at.leads_away()) {
      fly(at, rng);
      return;
    }
    const double missed = 1 - escape_chance(at);
    const double step = -std::log1p(-rng.uniform() * missed) / rate(at.travel);
    at.depth = std::max(0.0, at.depth - step);
  }

  // Returns the place where light that comes to the surface from afar meets its first facet.
  Place first_facet(Side side, const Vec3& travel, Rng& rng) const {
    Place at{side, travel, 0};
    fly(at, rng);
    return at;
  }

  // Returns the density over the new direction, 1/sr, of being mirrored from x by a facet; `h` is its normal.
  double mirror_density(const Vec3& x, const Vec3& h) const { return ggx_.d(h) / (4 * area(x)); }

  // Returns the density over `beyond` (as refract() has it), 1/sr, of passing a facet of normal `h` from x.
  double passing_density(const Vec3& x, const Vec3& h, const Vec3& beyond, double ratio) const {
    const double near = -dot(x, h), far = dot(beyond, h);
    return ggx_.d(h) * near * far / (area(x) * square(far - ratio * near));
  }

 private:
  Ggx ggx_;
  double u2_, v2_;
};

}  // namespace sunbeam::walk
