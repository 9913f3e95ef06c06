// This is what sample() draws the rest from: for each viewer a density over the root of cos(theta_i), linear
// between even nodes, uniform in azimuth. Rows are for viewers at even roots of cos(theta_o); between two of
// them one is chosen by lot, and the density is their mixture.
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

  // Returns the root of the cosine of a node.
  static double root_of_node(int node) { return static_cast<double>(node) / kIntervals; }

  // Adds the rows in the order of viewers. `density` is that at each node over the root, in any unit, >= 0;
  // its integral is returned.
  double add_row(std::span<const double> density) {
    std::array<double, kIntervals> power;
    for (std::size_t k = 0; k < kIntervals; ++k) power[k] = density[k] + density[k + 1];
    rows_.emplace_back(power);
    double total = 0;
    for (const double p : power) total += p / (2 * kIntervals);
    for (const double d : density) density_.push_back(static_cast<float>(total > 0 ? d / total : 1));
    return total;
  }

  // Returns the density over the root, of a viewer among the rows and a light among the nodes.
  float density(const EvenPosition& viewer, const EvenPosition& light) const {
    const float* row = density_.data() + viewer.lower * kNodes;
    const float low = lerp(row, light), high = lerp(row + kNodes, light);
    return low + viewer.upper_weight * (high - low);
  }

  // Draws the root of cos(theta_i), > 0.
  float sample(int viewer, double u) const {
    const auto [k, left] = rows_[static_cast<std::size_t>(viewer)].draw(u);
    const float* ends = density_.data() + static_cast<std::size_t>(viewer) * kNodes + k;
    // The distribution over the interval is a x^2 / 2 + (1 - a / 2) x with the slope a of the density.
    const float x = 1 - left, low = ends[0], high = ends[1];
    const float rising = std::max(low * low + x * (high - low) * (high + low), 0.0f);
    const float inside = x * (low + high) / (low + std::sqrt(rising) + 1e-30f);
    return (static_cast<float>(k) + std::min(inside, 1.0f)) * (1.0f / kIntervals);
  }

 private:
  static constexpr int kIntervals = kNodes - 1;

  std::vector<AliasTable<kIntervals>> rows_;
  std::vector<float> density_;
};

}  // namespace v1
}  // namespace sunbeam
