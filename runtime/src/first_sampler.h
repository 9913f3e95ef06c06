// What sample() draws the first surface of an isotropic rough film from: visible normals (ggx.h, bounded),
// drawn from the unit square not evenly but in proportion to what the film reflects there and the facets let
// out. Cells of the square, for viewers at even roots of the cosine; between two of them one is chosen by
// lot, and the density is their mixture.
//
// The square is (azimuth of the mirrored cap about the viewer's over 2 pi, height in the cap). Both halves of
// the azimuth are mirror images.
#pragma once

#include <span>
#include <vector>

#include "alias_table.h"
#include "color4.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/core/warp.h"

namespace sunbeam {

class FirstSampler {
 public:
  static constexpr int kTurns = 16, kHeights = 32, kCells = kTurns * kHeights;

  // Of cells, turn by turn; any unit, >= 0. In the order of RestSampler's rows.
  void add_row(std::span<const double> power) { rows_.emplace_back(power); }

  // In the square.
  Point2 sample(const EvenPosition& viewer, Rng& rng) const {
    const bool upper = rng.uniform() < viewer.upper_weight;
    const std::size_t cell = rows_[static_cast<std::size_t>(viewer.lower + (upper ? 1 : 0))].draw(rng.next());
    const double turn = 2 * rng.uniform() - 1;  // in the cell or in its mirror image
    const auto of_half = static_cast<double>(cell / kHeights);
    return {(turn < 0 ? 2 * kTurns - 1 - of_half + (turn + 1) : of_half + turn) / (2 * kTurns),
            (static_cast<double>(cell % kHeights) + rng.uniform()) / kHeights};
  }

  // Density over the square; the azimuth's cosine, which tells both halves, is x / sqrt(length2).
  float density(const EvenPosition& viewer, float x, float length2, float height) const {
    const int turn = turn_at(x * std::abs(x), length2);
    const int level = std::clamp(static_cast<int>(height * kHeights), 0, kHeights - 1);
    const auto* row = rows_.data() + viewer.lower;
    const auto cell = static_cast<std::size_t>(turn * kHeights + level);
    const float low = row[0].density(cell), high = row[1].density(cell);
    return low + viewer.upper_weight * (high - low);
  }

 private:
  // The cosine falls along the half turn; squares keep its sign.
  static int turn_at(float square, float length2) {
    int turn = 0;
    for (const float edge : kEdges) turn += square < edge * length2;
    return turn;
  }
  static const std::array<float, kTurns> kEdges;  // signed square of cos(pi k / kTurns), k = 1 to kTurns

  std::vector<AliasTable<kCells>> rows_;
};

inline const std::array<float, FirstSampler::kTurns> FirstSampler::kEdges = [] {
  std::array<float, kTurns> edges;
  for (int k = 1; k < kTurns; ++k) {
    const double cosine = std::cos(kPi * k / kTurns);
    edges[static_cast<std::size_t>(k - 1)] = static_cast<float>(cosine * std::abs(cosine));
  }
  edges.back() = -2;  // never: it fills the register
  return edges;
}();

}  // namespace sunbeam
