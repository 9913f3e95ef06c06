// What sample() draws the first surface of an isotropic rough film from: visible normals (facets.h), drawn
// from the unit square not evenly but in proportion to what the film reflects there and the facets let out.
// Cells of the square, for viewers at even roots of the cosine; between two of them one is chosen by lot, and
// the density is their mixture.
//
// The square is (azimuth of the mirrored cap about the viewer's over 2 pi, height in the cap). Both halves of
// the azimuth are mirror images.
#pragma once

#include <span>
#include <vector>

#include "alias_table.h"
#include "facets.h"

namespace sunbeam {

class FirstSampler {
 public:
  static constexpr int kRows = 33;
  static constexpr int kTurns = 16, kHeights = 64, kCells = kTurns * kHeights;

  FirstSampler() : density_(kCells * kStride) {}

  // Of cells, turn by turn; any unit, >= 0. In the order of viewers.
  void add_row(std::span<const double> power) {
    rows_.emplace_back(power);
    const auto densities = rows_.back().densities();
    for (std::size_t cell = 0; cell < kCells; ++cell)
      density_[cell * kStride + rows_.size() - 1] = static_cast<float>(densities[cell]);
  }

  struct Point {
    float turn, height;
  };
  static Point even(Rng& rng) {
    const float turn = uniform_float(rng);
    return {turn, uniform_float(rng)};
  }
  // In the square.
  Point sample(int row, Rng& rng) const {
    const std::size_t cell = rows_[static_cast<std::size_t>(row)].draw(rng.next());
    const std::uint32_t random = rng.next();  // its highest bit chooses the cell or its mirror image
    const std::size_t turn = (cell / kHeights) ^ ((random >> 31) * (2 * kTurns - 1));
    const float inside = static_cast<float>((random << 1) >> 8) * 0x1p-24f;
    return {(static_cast<float>(turn) + inside) * (0.5f / kTurns),
            (static_cast<float>(cell % kHeights) + uniform_float(rng)) * (1.0f / kHeights)};
  }

  // Density over the square of drawing the normal along h. Stretched to roughness 1 and times r (facets.h),
  // with h' = (h.x, h.y, a h.z) the mirrored wo is m = e h' - wo', e = a l^2 / |h'|^2; its height is that of
  // m.z, and its azimuth has the cosine m.wo' / (|m| |wo'|) in the plane.
  float density(const EvenPosition& row, float alpha, const FacetViewer& o, const FacetPair& pair) const {
    const float e = alpha * alpha * alpha * pair.l2_per_q;
    const float z = e * alpha * pair.z - o.cosine, below_top = o.r - z;
    const float along = e * (pair.x * o.x + pair.y * o.y) - alpha * o.sine2;
    const int turn = turn_at(along * std::abs(along), below_top * (o.r + z) * o.sine2);
    const int level = std::clamp(static_cast<int>(below_top * (2 * kHeights) * o.pdf_per_d), 0, kHeights - 1);
    const float* viewers = density_.data() + (turn * kHeights + level) * kStride + row.lower;
    return viewers[0] + row.upper_weight * (viewers[1] - viewers[0]);
  }

 private:
  static constexpr std::size_t kStride = kRows + 1;

  // The cosine falls along the half turn; squares keep its sign.
  static int turn_at(float square, float length2) {
    int turn = 0;
    for (const float edge : kEdges) turn += square < edge * length2;
    return turn;
  }
  static const std::array<float, kTurns> kEdges;  // signed square of cos(pi k / kTurns), k = 1 to kTurns

  std::vector<AliasTable<kCells>> rows_;
  std::vector<float> density_;  // (cell, viewer), so that both viewers are neighbours
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
