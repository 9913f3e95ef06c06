// What sample() draws the rest from: for each viewer a density over the root of cos(theta_i), uniform in
// azimuth. Rows for viewers at even roots of cos(theta_o); between two of them one is chosen by lot, and the
// density is their mixture.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "color4.h"

namespace sunbeam {

class RestSampler {
 public:
  static constexpr int kRows = 33;
  static constexpr int kBins = 64;

  // The viewer of a row; at grazing a little above.
  static double cosine_of_row(int row);
  static double middle_of_bin(int bin) { return (bin + 0.5) / kBins; }

  // In order of rows. `density` of each bin over the root, in any unit, >= 0; `first_chance` of the first
  // surface.
  void add_row(std::span<const double> density, double first_chance);

  // Where a viewer lies among the rows.
  EvenPosition viewer(float root) const { return EvenPosition(root, kRows); }
  float first_chance(const EvenPosition& viewer) const {
    return chance_[viewer.lower] + viewer.upper_weight * (chance_[viewer.lower + 1] - chance_[viewer.lower]);
  }

  // Root of cos(theta_i); u in [0, 1).
  double sample(const EvenPosition& viewer, double u) const;
  // Of a direction whose root that is, 1/sr; `per_root` = 1 / root.
  float pdf(const EvenPosition& viewer, float root, float per_root) const {
    const int bin = std::min(static_cast<int>(root * kBins), kBins - 1);
    const Row* row = rows_.data() + viewer.lower;
    const float low = row[0].density[static_cast<std::size_t>(bin)],
                high = row[1].density[static_cast<std::size_t>(bin)];
    constexpr float kPerSolidAngle = static_cast<float>(kInvPi / 4);  // d(root) / d(cosine) / (2 pi)
    return (low + viewer.upper_weight * (high - low)) * kPerSolidAngle * per_root;
  }

 private:
  struct Row {
    std::array<float, kBins + 1> cdf;
    std::array<float, kBins> density;       // over the root, its mean 1
    std::array<std::uint8_t, kBins> guide;  // the bin where cdf passes k / kBins
  };
  std::vector<Row> rows_;
  std::array<float, kRows> chance_{};
};

}  // namespace sunbeam
