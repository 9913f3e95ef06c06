// How even the throughput of sample() is, the noise a table adds to a picture by how it draws directions: the
// standard deviation of its mean over channels, relative to its mean, empty draws counted as 0.
#pragma once

#include <vector>

#include "bake/recipe/recipe.h"
#include "sunbeam/table.h"
#include "tests/support/stats.h"

namespace sunbeam {

inline double throughput_deviation(const Bsdf& bsdf, const Vec3& wo, int draws, Rng& rng) {
  test::RunningMean throughput;
  for (int k = 0; k < draws; ++k) {
    const auto sample = bsdf.sample(wo, rng);
    throughput.add(sample ? mean(sample->throughput) : 0);
  }
  return std::sqrt(throughput.variance()) / throughput.mean();
}

// Random points of the recipe's grid, and those of its corners that do not absorb, where the base is bright.
inline std::vector<Parameters> materials_of(const Recipe& recipe, int random_points, Rng& rng) {
  const Axis &thickness = recipe.grid[0], &ior = recipe.grid[1], &absorption = recipe.grid[2];
  const auto within = [&](const Axis& axis) { return lerp(rng.uniform(), axis.low(), axis.high()); };
  std::vector<Parameters> points;
  for (int k = 0; k < random_points; ++k)
    points.push_back({within(thickness), within(ior), within(absorption)});
  for (const double d : {thickness.low(), thickness.high()})
    for (const double n : {ior.low(), ior.high()}) points.push_back({d, n, absorption.low()});
  return points;
}

}  // namespace sunbeam
