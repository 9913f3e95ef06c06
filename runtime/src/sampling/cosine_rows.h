// This is what sample() draws the rest from: for each viewer a density over the root of cos(theta_i), linear
// between even nodes, uniform in azimuth. Rows are for viewers at even roots of cos(theta_o); between two of
// them one is chosen by lot, and the density is their mixture. The densities themselves are the owner's.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "runtime/src/sampling/alias_table.h"
#include "runtime/src/sampling/facets.h"

namespace sunbeam {
inline namespace v1 {

class CosineRows {
 public:
  static constexpr int kNodes = 33;  // of lights
  static constexpr int kIntervals = kNodes - 1;

  // Returns the root of the cosine of a node.
  static double root_of_node(int node) { return static_cast<double>(node) / kIntervals; }

  // Adds the rows in the order of viewers. `density` is that at each node over the root, in any unit, >= 0;
  // it is scaled to an integral of 1, and what that was is returned.
  double add_row(std::span<double> density) {
    std::array<double, kIntervals> power;
    double total = 0;
    for (std::size_t k = 0; k < kIntervals; ++k) {
      power[k] = density[k] + density[k + 1];
      total += power[k] / (2 * kIntervals);
    }
    rows_.emplace_back(power);
    for (double& d : density) d = total > 0 ? d / total : 1;
    return total;
  }

  // Draws the interval that the root of cos(theta_i) lies in.
  auto draw(int viewer, double u) const { return rows_[static_cast<std::size_t>(viewer)].draw(u); }

  // Returns the root, > 0, in an interval with the densities `low` and `high` at its ends. With x the
  // distance from the lower one, x low + x^2 (high - low) / 2 is what is left of the number over the mean
  // density.
  static float root(const AliasTable<kIntervals>::Drawn& drawn, float low, float high) {
    const float y = 1 - drawn.left;
    const float root = std::sqrt(std::max(low * low + y * (high - low) * (high + low), 0.0f));
    const float inside = std::min(y * (low + high) / (low + root + 1e-30f), 1.0f);
    return (static_cast<float>(drawn.bin) + inside) * (1.0f / kIntervals);
  }

  std::size_t bytes() const { return rows_.size() * sizeof(rows_[0]); }

 private:
  std::vector<AliasTable<kIntervals>> rows_;
};

}  // namespace v1
}  // namespace sunbeam
