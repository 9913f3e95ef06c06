// This file gives the radiance that arrives from infinity, and draws directions from lat-long maps by
// importance. EnvironmentSource describes the mapping.
#pragma once

#include "runtime/tracer/scene.h"
#include "sunbeam/detail/piecewise.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

class Environment {
 public:
  // `source` must outlive this.
  explicit Environment(const EnvironmentSource& source);

  // Only a map can be sampled. A constant environment is left to BSDF sampling, which is optimal for it.
  bool can_sample() const { return !source_.map.empty(); }

  // Returns the mean radiance of the map over the sphere, channels averaged. It may be called only if
  // can_sample().
  double mean_radiance() const { return kPi / 2 * rows_.integral(); }

  // Returns the radiance along the unit direction `wi` that points away from the scene.
  Rgb radiance(const Vec3& wi) const;

  // Draws a direction with density proportional to the radiance of the map, channels averaged.
  Vec3 sample(const Point2& u) const;
  // Returns the density of sample() per solid angle (1/sr); 0 if !can_sample().
  double pdf(const Vec3& wi) const;

 private:
  const EnvironmentSource& source_;
  PiecewiseConstant rows_;
  std::vector<PiecewiseConstant> columns_;  // one for each row
};

}  // namespace sunbeam
