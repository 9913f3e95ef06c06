// This file says where a facet of the film sends light and how much of it the other facets let by. It is all
// of the film but its reflectance.
//
// Directions: outside directions `w` and inside directions `m` are unit vectors with z > 0; w points away
// from the surface, m away from the base. Light that enters along w reaches the base along m; light that
// leaves the base along m leaves the film along w, or is thrown back and reaches the base again along another
// m. A result is empty where the light is lost in the microsurface (single scattering), which is part of the
// model. Shares are those of power; the radiance's squared index ratio is the caller's affair.
#pragma once

#include <optional>

#include "sunbeam/detail/ggx.h"
#include "sunbeam/material.h"

namespace sunbeam {

// Says where light goes on, and which share of it masking facets leave.
struct Onward {
  Vec3 direction;
  double share;
};

class FilmGeometry {
 public:
  explicit FilmGeometry(const Material& material);

  bool is_smooth() const { return !rough_; }
  // Says whether facets bend what crosses, so that leaving along a given w has a density over m.
  bool has_glossy_crossing() const { return rough_ && bends_; }
  bool bends() const { return bends_; }
  double index_ratio() const { return index_ratio_; }
  const Ggx& ggx() const { return ggx_; }

  // Returns the normal of a facet that light along w meets, drawn with density D_vis(h; w); for a smooth film
  // it is the macro normal.
  Vec3 visible_normal(const Vec3& w, const Point2& u) const {
    return rough_ ? ggx_.sample_visible(w, u) : Vec3{0, 0, 1};
  }

  // These let light along w cross the facet of normal h to the inside, or light along m to the outside.
  std::optional<Onward> cross(const Vec3& w, const Vec3& h) const { return cross(w, h, index_ratio_); }
  std::optional<Onward> leave(const Vec3& m, const Vec3& h) const { return cross(m, h, 1 / index_ratio_); }

  // Lets the facet of normal h mirror light along w to its own side. Light thrown down arrives from m
  // mirrored at the facet turned half round, and that turn leaves the distribution of normals as it is.
  std::optional<Onward> mirror(const Vec3& w, const Vec3& h) const;

 private:
  std::optional<Onward> cross(const Vec3& from, const Vec3& h, double index_ratio) const;
  double shadowing(const Vec3& from, const Vec3& to) const { return rough_ ? ggx_.g2_over_g1(from, to) : 1; }

  double index_ratio_;  // n0 / n2 in "refract" mode, else 1
  bool rough_, bends_, straight_;
  Ggx ggx_;
};

}  // namespace sunbeam
