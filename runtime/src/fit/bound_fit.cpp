#include "runtime/src/fit/bound_fit.h"

#include <functional>

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastCosine = 1e-4;
constexpr double kLeastShare = 0.3;    // of the channels' mean: a folded colour may pass through 0
constexpr double kLeastScale = 1e-18;  // and a pigment let nothing through; its square is a float yet

constexpr double kMostRatio = 1e30;  // a float yet, times two scales

// Directions at cosines that are even, or whose roots are, and at even azimuths of a quadrant.
struct Grid {
  int cosines, phis;
  bool by_root;
  bool enters = false;  // those that a smooth film keeps out give way to the next that it lets in
};

std::vector<BoundWaves::Direction> directions_of(const BoundWaves& waves, const Grid& grid) {
  std::vector<BoundWaves::Direction> directions;
  for (int c = 0; c < grid.cosines; ++c)
    for (int p = 0; p < grid.phis; ++p) {
      const double x = static_cast<double>(c) / (grid.cosines - 1);
      double cosine = std::max(grid.by_root ? x * x : x, kLeastCosine);
      if (grid.enters) cosine = entering_cosine(waves.material(), cosine);
      directions.push_back(waves.direction(cosine, grid.phis == 1 ? 0 : kPi / 2 * p / (grid.phis - 1)));
    }
  return directions;
}

Rgb scale_of(const BoundWaves& waves, const BoundWaves::Direction& w) {
  const Rgb arriving = waves.arriving(w);
  const double least = std::max(kLeastShare * mean(arriving), kLeastScale);
  return transform(arriving, [least](double a) { return std::max(a, least); });
}

// S at each node, to the front of `scales`.
void find_scales(const BoundWaves& waves, const Grid& grid, std::vector<Color4>& scales) {
  const auto directions = directions_of(waves, grid);
  for (std::size_t k = 0; k < directions.size(); ++k) scales[k] = to_color4(scale_of(waves, directions[k]));
}

// Q at each pair of nodes, to the front of `ratios`; both directions may be exchanged. Beyond the critical
// angle of a smooth film both rest and S are 0, and look-ups just inside it need the limit of their quotient.
void find_ratios(const BoundWaves& waves, const Grid& grid, std::vector<Color4>& ratios) {
  const auto nodes = directions_of(waves, grid);
  std::vector<Rgb> scales;
  for (const auto& w : nodes) scales.push_back(scale_of(waves, w));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto row = waves.row(nodes[i]);
    for (std::size_t o = 0; o <= i; ++o) {
      const Rgb ratio = transform(waves.rest(row, nodes[o]) / (scales[i] * scales[o]),
                                  [](double q) { return std::clamp(q, -kMostRatio, kMostRatio); });
      ratios[i * nodes.size() + o] = ratios[o * nodes.size() + i] = to_color4(ratio);
    }
  }
}

}  // namespace

Separable fit_isotropic(const BoundWaves& waves) {
  Separable fit;
  find_scales(waves, {Separable::kScaleCosines, 1, false}, fit.scales);
  find_ratios(waves, {Separable::kRatioRoots, 1, true, true}, fit.ratios);
  return fit;
}

AnisotropicSeparable fit_anisotropic(const BoundWaves& waves) {
  using Fit = AnisotropicSeparable;
  Fit fit;
  fit.scales.resize(Fit::kScaleCosines * Fit::kScaleAzimuths);
  fit.ratios.resize(Fit::kRatioNodes * Fit::kRatioNodes);
  find_scales(waves, {Fit::kScaleCosines, Fit::kScaleAzimuths, false}, fit.scales);
  find_ratios(waves, {Fit::kRatioRoots, Fit::kRatioAzimuths, true, true}, fit.ratios);
  return fit;
}

}  // namespace v1
}  // namespace sunbeam
