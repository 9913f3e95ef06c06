// Radiance arriving from infinity, with importance sampling of lat-long maps (mapping: EnvironmentSource).
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

  // Of the map over the sphere, channels averaged. Only if can_sample().
  double mean_radiance() const { return kPi / 2 * rows_.integral(); }

  // Radiance along the unit direction `wi` that points away from the scene.
  Rgb radiance(const Vec3& wi) const;

  // A direction with density proportional to the radiance of the map, channels averaged.
  Vec3 sample(const Point2& u) const;
  // Density of sample() per solid angle; 0 if !can_sample().
  double pdf(const Vec3& wi) const;

 private:
  const EnvironmentSource& source_;
  PiecewiseConstant rows_;
  std::vector<PiecewiseConstant> columns_;  // one for each row
};

}  // namespace sunbeam
