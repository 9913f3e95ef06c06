// What sample() draws the rest from: for each viewer a density over the root of cos(theta_i), uniform in
// azimuth. Rows for viewers at even roots of cos(theta_o); between two of them one is chosen by lot, and the
// density is their mixture.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "alias_table.h"
#include "color4.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {

class RestSampler {
 public:
  static constexpr int kRows = 33;
  static constexpr int kBins = 64;

  // The viewer of a row; at grazing a little above.
  static double cosine_of_row(int row) {
    constexpr double kSmallestCosine = 1e-4;
    const double root = static_cast<double>(row) / (kRows - 1);
    return std::max(root * root, kSmallestCosine);
  }
  static double middle_of_bin(int bin) { return (bin + 0.5) / kBins; }

  // In order of rows. `density` of each bin over the root, in any unit, >= 0; `first_chance` of the first
  // surface.
  void add_row(std::span<const double> density, double first_chance) {
    chance_[rows_.size()] = static_cast<float>(first_chance);
    rows_.emplace_back(density);
  }

  // Where a viewer lies among the rows.
  EvenPosition viewer(float root) const { return EvenPosition(root, kRows); }
  float first_chance(const EvenPosition& viewer) const {
    return chance_[viewer.lower] + viewer.upper_weight * (chance_[viewer.lower + 1] - chance_[viewer.lower]);
  }

  // Root of cos(theta_i), > 0.
  double sample(const EvenPosition& viewer, Rng& rng) const {
    const bool upper = rng.uniform() < viewer.upper_weight;
    const std::size_t bin = rows_[static_cast<std::size_t>(viewer.lower + (upper ? 1 : 0))].draw(rng.next());
    return (static_cast<double>(bin) + 1 - rng.uniform()) / kBins;
  }
  // Of a direction whose root that is, 1/sr; `per_root` = 1 / root.
  float pdf(const EvenPosition& viewer, float root, float per_root) const {
    const int bin = std::min(static_cast<int>(root * kBins), kBins - 1);
    const auto* row = rows_.data() + viewer.lower;
    const float low = row[0].density(static_cast<std::size_t>(bin)),
                high = row[1].density(static_cast<std::size_t>(bin));
    constexpr float kPerSolidAngle = static_cast<float>(kInvPi / 4);  // d(root) / d(cosine) / (2 pi)
    return (low + viewer.upper_weight * (high - low)) * kPerSolidAngle * per_root;
  }

 private:
  std::vector<AliasTable<kBins>> rows_;
  std::array<float, kRows> chance_{};
};

}  // namespace sunbeam
