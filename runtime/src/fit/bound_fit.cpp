#include "runtime/src/fit/bound_fit.h"

#include <functional>

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastCosine = 1e-4;
constexpr double kLeastShare = 0.3;    // of the channels' mean: a folded colour may pass through 0
constexpr double kLeastScale = 1e-18;  // and a pigment let nothing through; its square is a float yet

constexpr double kMostRatio = 1e30;  // a float yet, times two scales
// Between nodes of Q: where fewer roots do better than that, they stay, since others take four times the
// memory.
constexpr double kMostFirstError = 5e-4, kMostRatioError = 0.002;

// Directions at cosines that are even, or whose roots are, and at even azimuths of a quadrant.
struct Grid {
  int cosines, phis;
  bool by_root;
  bool enters = false;  // those that a smooth film keeps out give way to the next that it lets in
};

template <class Visit>
void for_each_direction(const BoundWaves& waves, const Grid& grid, Visit visit) {
  for (int c = 0; c < grid.cosines; ++c)
    for (int p = 0; p < grid.phis; ++p) {
      const double x = static_cast<double>(c) / (grid.cosines - 1);
      double cosine = std::max(grid.by_root ? x * x : x, kLeastCosine);
      if (grid.enters) cosine = entering_cosine(waves.material(), cosine);
      visit(waves.direction(cosine, grid.phis == 1 ? 0 : kPi / 2 * p / (grid.phis - 1)));
    }
}

Rgb scale_of(const BoundWaves& waves, const BoundWaves::Direction& w) {
  const Rgb arriving = waves.arriving(w);
  const double least = std::max(kLeastShare * mean(arriving), kLeastScale);
  return transform(arriving, [least](double a) { return std::max(a, least); });
}

// S at each node, to the front of `scales`.
void find_scales(const BoundWaves& waves, const Grid& grid, std::vector<Color4>& scales) {
  std::size_t k = 0;
  for_each_direction(waves, grid,
                     [&](const BoundWaves::Direction& w) { scales[k++] = to_color4(scale_of(waves, w)); });
}

// Q at each pair of nodes, to the front of `ratios`; both directions may be exchanged. Beyond the critical
// angle of a smooth film both rest and S are 0, and look-ups just inside it need the limit of their quotient.
void find_ratios(const BoundWaves& waves, const Grid& grid, std::vector<Color4>& ratios) {
  std::vector<BoundWaves::Direction> nodes;
  std::vector<Rgb> scales;
  for_each_direction(waves, grid, [&](const BoundWaves::Direction& w) {
    nodes.push_back(w);
    scales.push_back(scale_of(waves, w));
  });
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto row = waves.row(nodes[i]);
    for (std::size_t o = 0; o <= i; ++o) {
      const Rgb ratio = transform(waves.rest(row, nodes[o]) / (scales[i] * scales[o]),
                                  [](double q) { return std::clamp(q, -kMostRatio, kMostRatio); });
      ratios[i * nodes.size() + o] = ratios[o * nodes.size() + i] = to_color4(ratio);
    }
  }
}

double magnitude(const Rgb& color) {
  return mean(transform(color, [](double x) { return std::abs(x); }));
}

// Of the rest between nodes of Q: the largest relative error that a direction has in the mean over others. A
// film may be so colourful that a channel's wavelengths reach the base along quite different directions.
double ratio_error(const BoundWaves& waves, const Separable& fit) {
  constexpr int kStep = 3;              // every third interval serves
  constexpr double kLeastRoot = 0.1;    // closer to grazing there is no light to speak of
  constexpr double kLeastWhole = 1e-4;  // of the brightest direction
  std::vector<BoundWaves::Direction> between;
  std::vector<EvenPosition> at;
  std::vector<Rgb> scales;
  std::vector<float> cosines;
  for (int k = 0; k + 1 < fit.ratio_roots; k += kStep) {
    const double root = (k + 0.5) / (fit.ratio_roots - 1);
    if (root < kLeastRoot) continue;
    cosines.push_back(static_cast<float>(entering_cosine(waves.material(), root * root)));
    between.push_back(waves.direction(double{cosines.back()}, 0));
    scales.push_back(scale_of(waves, between.back()));
    at.emplace_back(std::sqrt(cosines.back()), fit.ratio_roots);
  }
  std::vector<double> wrongs, wholes;
  for (std::size_t i = 0; i < between.size(); ++i) {
    const auto row = waves.row(between[i]);
    double wrong = 0, whole = 0;
    for (std::size_t o = 0; o < between.size(); ++o) {
      const Rgb rest = waves.rest(row, between[o]);
      const Rgb found = to_rgb(fit.ratio(at[i], at[o])) * scales[i] * scales[o];
      wrong += std::sqrt(cosines[o]) * cosines[o] * magnitude(found - rest);
      whole += std::sqrt(cosines[o]) * cosines[o] * magnitude(rest);
    }
    wrongs.push_back(wrong);
    wholes.push_back(whole);
  }
  const double least = kLeastWhole * *std::max_element(wholes.begin(), wholes.end());
  double worst = 0;
  for (std::size_t i = 0; i < wholes.size(); ++i)
    if (wrongs[i] > 0) worst = std::max(worst, wrongs[i] / std::max(wholes[i], least));
  return worst;
}

}  // namespace

Separable fit_isotropic(const BoundWaves& waves) {
  const bool has_layers = waves.has_layers();
  const int most = has_layers ? Separable::kMostRatioRoots : Separable::kMostClearRoots;
  for (int roots = has_layers ? Separable::kMostClearRoots : Separable::kRatioRoots;; roots = 2 * roots - 1) {
    Separable fit(roots);
    find_ratios(waves, {roots, 1, true, true}, fit.ratios);
    const double allowed = roots == Separable::kRatioRoots ? kMostFirstError : kMostRatioError;
    if (2 * roots - 1 <= most && ratio_error(waves, fit) > allowed) continue;
    find_scales(waves, {Separable::kScaleCosines, 1, false}, fit.scales);
    return fit;
  }
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
