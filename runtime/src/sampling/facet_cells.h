// This is what sample() draws the first surface of an isotropic rough film from: visible normals (facets.h),
// drawn from the unit square not evenly but in proportion to what the film reflects there and the facets let
// out. The square has cells, for viewers at even roots of the cosine; between two of them one is chosen by
// lot, and the density is their mixture.
//
// The square is (azimuth of the mirrored cap about the viewer's over 2 pi, height in the cap). Both halves of
// the azimuth are mirror images.
#pragma once

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
  // The first number chooses the cell; what is left of it lies across the heights. The second one lies across
  // the turns of the cell and then of its mirror image.
  Point sample(int row, double u, double v) const {
    const auto [cell, left] = rows_[static_cast<std::size_t>(row)].draw(u);
    const double whole = v < 0.5 ? 0 : 1;
    const std::uint32_t mirrored = v < 0.5 ? 0 : 2 * kTurns - 1;
    return {FloatTurn((cell / kHeights) ^ mirrored, static_cast<float>(2 * v - whole)),
            (static_cast<float>(cell % kHeights) + left) * (1.0f / kHeights)};
  }

  // Returns the cells that the normals along h fall into. Stretched to roughness 1 and times r (facets.h),
  // with h' = (h.x, h.y, a h.z) the mirrored wo is m = e h' - wo', e = a l^2 / |h'|^2; its height is that of
  // m.z, and its azimuth has the cosine m.wo' / (|m| |wo'|) in the plane.
  template <int kLights>
  static Ints4 cells(float alpha, const FacetViewer& o, const FacetLights<kLights>& lights) {
    const Color4 e = alpha * alpha * alpha * lights.l2_per_q;
    const Color4 z = e * alpha * lights.z - o.cosine, below_top = o.r - z;
    const Color4 along = e * (lights.x * o.x + lights.y * o.y) - alpha * o.sine2;
    const Ints4 turn = turn_at(along, below_top * (o.r + z) * o.sine2);
    const Color4 level = below_top * (2 * kHeights * o.pdf_per_d);
    const Color4 last = Color4{1, 1, 1, 1} * float{kHeights - 1};
    return turn * kHeights + convert<Ints4>(max4(min4(level, last), Color4{}));
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
  static constexpr std::size_t kStride = kRows + 1;
  static constexpr double kWholeShare = 65535;

  // The half turn's cosine is x / sqrt(length2); one of its quarters is the other's mirror image.
  static Ints4 turn_at(const Color4& x, const Color4& length2) {
    Ints4 turn{};
    for (const float edge : kEdges) turn -= x * x < edge * length2;
    return turn ^ ((x < 0) & (kTurns - 1));
  }
  static const std::array<float, kTurns / 2 - 1> kEdges;  // squared cosine at pi k / kTurns, k = 1, 2 ...

  std::vector<AliasTable<kCells>> rows_;
  std::vector<std::uint16_t> share_;          // (cell, viewer), so that both viewers are neighbours
  std::array<float, kRows + 1> per_share_{};  // density over the square
};

inline const std::array<float, FacetCells::kTurns / 2 - 1> FacetCells::kEdges = [] {
  std::array<float, kTurns / 2 - 1> edges;
  for (std::size_t k = 0; k < edges.size(); ++k)
    edges[k] = static_cast<float>(square(std::cos(kPi * static_cast<double>(k + 1) / kTurns)));
  return edges;
}();

}  // namespace v1
}  // namespace sunbeam
