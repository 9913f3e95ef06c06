// This is what sample() draws the first surface of an isotropic rough film from: visible normals (facets.h),
// drawn from the unit square not evenly but in proportion to what the film reflects there and the facets let
// out. The square has cells, for viewers at even roots of the cosine; between two of them one is chosen by
// lot, and the density is their mixture.
//
// The square is (azimuth of the mirrored cap about the viewer's over 2 pi, height in the cap). Both halves of
// the azimuth are mirror images.
#pragma once

#include <bit>
#include <span>
#include <vector>

#include "runtime/src/sampling/alias_table.h"
#include "runtime/src/sampling/facets.h"

namespace sunbeam {
inline namespace v1 {

class FacetCells {
 public:
  static constexpr int kRows = 17;
  static constexpr int kTurns = 16, kHeights = 32, kCells = kTurns * kHeights;
  static_assert(2 * kTurns == FloatTurn::kSteps);

  // Returns the viewer's cosine of a row.
  static double cosine_of_row(int row) {
    constexpr double kLeastCosine = 1e-4;
    return std::max(square(static_cast<double>(row) / (kRows - 1)), kLeastCosine);
  }

  // Adds the rows in the order of viewers. `power` is that of the cells, turn by turn, in any unit, >= 0.
  void add_row(std::span<const double> power) {
    share_.resize(kCells * kStride);
    const double most = *std::max_element(power.begin(), power.end());
    std::array<double, kCells> shares;
    double sum = 0;
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      shares[cell] = most > 0 ? std::max(1.0, std::round(power[cell] / most * kWholeShare)) : 1;
      share_[cell * kStride + rows_.size()] = static_cast<std::uint16_t>(shares[cell]);
      sum += shares[cell];
    }
    per_share_[rows_.size()] = static_cast<float>(kCells / sum);
    rows_.emplace_back(shares);
  }

  // Describes a point in the square.
  struct Point {
    FloatTurn turn;
    float height;
  };
  static Point even(double u, double v) { return {FloatTurn(u), static_cast<float>(v)}; }
  // The first number chooses the cell, and what is left of it lies across the turns. The second one lies
  // across the heights of the cell and then of its mirror image.
  Point sample(int row, double u, double v) const {
    const auto [cell, left] = rows_[static_cast<std::size_t>(row)].draw(u);
    const std::uint32_t is_mirrored = v < 0.5 ? 0 : 1;
    const auto height = static_cast<float>(2 * v - is_mirrored);
    return {FloatTurn((cell / kHeights) ^ (is_mirrored * (2 * kTurns - 1)), left),
            (static_cast<float>(cell % kHeights) + height) * (1.0f / kHeights)};
  }

  // Returns the cell that the normals along h fall into. Stretched to roughness 1 and times r (facets.h),
  // with h' = (h.x, h.y, a h.z) the mirrored wo is m = e h' - wo', e = a l^2 / |h'|^2; its height is that of
  // m.z, and its azimuth has the cosine m.wo' / (|m| |wo'|) in the plane.
  static int cell(float alpha, const FacetViewer& o, const FacetPair& pair) {
    const float e = alpha * alpha * alpha * pair.l2_per_q;
    const float z = e * alpha * pair.z - o.cosine, below_top = o.r - z;
    const float along = e * (pair.x * o.x + pair.y * o.y) - alpha * o.sine2;
    const int turn = turn_at(along, below_top * (o.r + z) * o.sine2);
    const float level = std::max(below_top * (2 * kHeights * o.pdf_per_d), 0.0f);
    return turn * kHeights + static_cast<int>(std::min(level, float{kHeights - 1}));
  }

  // Holds what a viewer decides of densities: the mixture of two rows, each over its shares.
  struct Mixture {
    Mixture(const FacetCells& cells, const EvenPosition& row)
        : row(row.lower),
          lower((1 - row.upper_weight) * cells.per_share_[static_cast<std::size_t>(row.lower)]),
          upper(row.upper_weight * cells.per_share_[static_cast<std::size_t>(row.lower) + 1]) {}
    int row;
    float lower, upper;
  };
  // Returns the density over the square.
  float density(const Mixture& viewer, int cell) const {
    const std::uint16_t* shares = share_.data() + static_cast<std::size_t>(cell) * kStride + viewer.row;
    return viewer.lower * static_cast<float>(shares[0]) + viewer.upper * static_cast<float>(shares[1]);
  }

  std::size_t bytes() const {
    return rows_.size() * sizeof(rows_[0]) + share_.size() * sizeof(std::uint16_t);
  }

 private:
  static constexpr std::size_t kStride = kRows;
  static constexpr double kWholeShare = 65535;

  // The half turn's cosine is x / sqrt(length2); one of its quarters is the other's mirror image.
  static int turn_at(float x, float length2) {
    const Color4 x2 = Color4{} + x * x;
    const int passed = mask_of(x2 < length2 * kEdges[0]) | mask_of(x2 < length2 * kEdges[1]) << 4;
    return std::bit_width(static_cast<unsigned>(passed)) ^ (x < 0 ? kTurns - 1 : 0);
  }
  // The squared cosines at pi k / kTurns, k = 1 to kTurns / 2; they fall, so that those passed come first.
  static const std::array<Color4, 2> kEdges;

  std::vector<AliasTable<kCells>> rows_;
  std::vector<std::uint16_t> share_;          // (cell, viewer), so that both viewers are neighbours
  std::array<float, kRows + 1> per_share_{};  // density over the square
};

inline const std::array<Color4, 2> FacetCells::kEdges = [] {
  static_assert(kTurns == 16);
  std::array<Color4, 2> edges{};
  for (int k = 0; k < kTurns / 2; ++k)
    edges[static_cast<std::size_t>(k / 4)][k % 4] =
        k + 1 == kTurns / 2 ? 0 : static_cast<float>(square(std::cos(kPi * (k + 1) / kTurns)));
  return edges;
}();

}  // namespace v1
}  // namespace sunbeam
