#include "sunbeam/detail/table_ranges.h"

#include <algorithm>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr Interval kReturned{0, 1};
// All visits of the base add up to 1 / (1 - albedo returned). A white base under indices of 5 comes to 0.96.
constexpr double kMostReturned = 0.999;
// ln A + tau/m~, where A is at most 1 and its logarithm at least -70. Beyond, a float is too coarse for exp.
constexpr Interval kArrival{-100, 1e6};
constexpr Interval kExchange{-1e30, 1e30};
constexpr double kHair = 1e-6;  // what rounding may add
constexpr Interval kCosine{-kHair, 1 + kHair};
// Thicknesses are divided by their sum.
constexpr double kLeastThickness = 1e-300;
// The longest path 2 sum(n d) of a layered film in wavelengths. Bakes have none beyond 46.
constexpr double kMostWaves = 50;
// Layers of one period times wavelengths under a spread, which evaluates each of them many times.
constexpr std::size_t kMostSpreadIndices = 4096;
// Shares of light: plainly, with what sums of numbers lack of 1, or folded into colours.
constexpr Interval kShare{-0.001, 1.01}, kFoldedShare{-1, 2};
constexpr Interval kRemainder{-1e7, 1e7}, kStandardError{0, 1e7};

void require(const NdArray& array, const Interval& allowed) {
  const auto low = static_cast<float>(allowed.low), high = static_cast<float>(allowed.high);
  const auto is_outside = [=](float value) { return !(value >= low && value <= high); };
  const auto at = std::ranges::find_if(array.values(), is_outside);
  if (at != array.values().end())
    throw Error("array '" + array.name() + "' leaves " + to_text(allowed.low) + " to " +
                to_text(allowed.high) + ": it holds " + to_text(*at));
}

// Cosines may not fall along the last axis, the rank of facets by them.
void require_ascending(const NdArray& array) {
  const std::size_t ranks = array.axes().back().size();
  const auto values = array.values();
  for (std::size_t cell = 1; cell < values.size(); ++cell)
    if (cell % ranks != 0 && values[cell] < values[cell - 1] - static_cast<float>(kHair))
      throw Error("array '" + array.name() + "' falls from " + to_text(values[cell - 1]) + " to " +
                  to_text(values[cell]) + " along 'facet_rank'; allowed: to rise");
}

void require_light_leaves(const Table& table, const NdArray& returned) {
  const auto& albedo = table.factors.wavelengths.albedo;
  const double most = *std::max_element(albedo.begin(), albedo.end()) *
                      double{*std::max_element(returned.values().begin(), returned.values().end())};
  if (most > kMostReturned)
    throw Error("array '" + returned.name() + "' times attribute 'spectral.albedo' reaches " + to_text(most) +
                "; allowed: up to " + to_text(kMostReturned));
}

void require_depths_of_product(const Table& table) {
  const auto& absorption = table.factors.wavelengths.absorption;
  const double deepest = table.factors.grid[2].high() * table.material.pigment_thickness_nm *
                         *std::max_element(absorption.begin(), absorption.end());
  if (deepest > kDeepestProduct)
    throw Error("absorption_per_nm reaches an optical depth of " + to_text(deepest) +
                "; allowed in a factored table of path product: up to " + to_text(kDeepestProduct));
}

void require_attribute(const std::string& key, double value, const Interval& allowed) {
  if (!(value >= allowed.low && value <= allowed.high))
    throw Error("attribute '" + key + "' holds " + to_text(value) + "; allowed: " + to_text(allowed.low) +
                " to " + to_text(allowed.high));
}

void require_layers(const Wavelengths& waves) {
  const double count = static_cast<double>(waves.layers.front().size()) * waves.film_periods;
  if (!(count >= 1 && count <= kMostFilmLayers))
    throw Error("attributes 'film.*' describe " + to_text(count) + " layers in all periods; allowed: 1 to " +
                std::to_string(kMostFilmLayers));
  for (const std::vector<FilmLayer>& layers : waves.layers)
    for (std::size_t j = 0; j < layers.size(); ++j) {
      const std::string prefix = "film." + std::to_string(j) + ".";
      require_attribute(prefix + "thickness_nm", layers[j].thickness_nm,
                        allowed_interval("film_thickness_nm"));
      require_attribute(prefix + "n", layers[j].index.real(), {kLeastIor, kLargestIor});
      require_attribute(prefix + "k", layers[j].index.imag(), {0, kMostExtinction});
    }
}

// The layers share the film's thickness as their own stand to each other.
void require_proportions(const Wavelengths& waves, double thickest) {
  double sum = 0;
  for (const FilmLayer& layer : waves.layers.front()) sum += layer.thickness_nm;
  sum *= waves.film_periods;
  const double most = allowed_interval("film_thickness_nm").high;
  if (sum == 0 ? thickest > 0 : !(sum >= kLeastThickness && sum <= most))
    throw Error("attributes 'film.*.thickness_nm' add up to " + to_text(sum) +
                " in all periods, of a film of " + to_text(thickest) + " nm; allowed: " +
                to_text(kLeastThickness) + " to " + to_text(most) + ", or 0 of a film of 0 nm");
}

// What is bound is tabulated over all fringes, however sharp.
void require_effort(const Table& table, double thickest) {
  const Wavelengths& waves = table.factors.wavelengths;
  for (std::size_t k = 0; k < waves.size(); ++k) {
    const double path = path_per_thickness(table.material, waves, k) * thickest / waves.nm[k];
    if (!(path <= kMostWaves))
      throw Error("film_thickness_nm reaches a path 2 sum(n d) of " + to_text(path) + " wavelengths at " +
                  to_text(waves.nm[k]) + " nm; allowed of a layered film: up to " + to_text(kMostWaves));
  }
  const std::size_t indices = waves.layers.empty() ? 1 : waves.layers.front().size() * waves.size();
  if (table.material.thickness_spread > 0 && indices > kMostSpreadIndices)
    throw Error("attributes 'film.*' hold " + std::to_string(indices) +
                " indices; allowed with thickness_spread: up to " + std::to_string(kMostSpreadIndices));
}

void require_base(const Table& table) {
  const bool is_opaque = table.material.is_opaque();
  const Interval ior = allowed_interval("base_ior", table.material);
  for (const std::complex<double>& index : table.factors.wavelengths.base_index) {
    require_attribute("base.n", index.real(), ior);
    require_attribute("base.k", index.imag(), {0, is_opaque ? kMostExtinction : 0});
  }
  const Axis& base_ior = table.factors.grid[1];
  if (base_ior.size() > 1)
    throw Error("grid axis 'base_ior' has " + std::to_string(base_ior.size()) +
                " nodes; a base of attributes 'base.*' has 1");
}

void require_film(const Table& table) {
  const Wavelengths& waves = table.factors.wavelengths;
  if (!is_layered(table.material, waves)) return;
  const double thickest = table.factors.grid[0].high();
  if (!waves.layers.empty()) {
    require_layers(waves);
    require_proportions(waves, thickest);
  }
  if (!waves.base_index.empty()) require_base(table);
  require_effort(table, thickest);
}

void require_factors(const Table& table) {
  const Factors& factors = table.factors;
  require(factors.returned, kReturned);
  require(factors.arrival, kArrival);
  require(factors.exchange, kExchange);
  require(factors.crossing, kArrival);
  require(factors.returning, kReturned);
  for (const NdArray* cosines : {&factors.facet_cosine, &factors.return_cosine})
    if (!cosines->empty()) {
      require(*cosines, kCosine);
      require_ascending(*cosines);
    }
  for (const NdArray* returned : {&factors.returned, &factors.returning})
    if (!returned->empty()) require_light_leaves(table, *returned);
  if (!factors.exchange.empty()) require_depths_of_product(table);
  require_film(table);
}

}  // namespace

void require_in_ranges(const Table& table) {
  const Interval share = table.is_full_spectrum() ? kFoldedShare : kShare;
  require(table.film_reflectance, share);
  require(table.film_transmittance, share);
  require(table.first_visit, kFoldedShare);
  require(table.remainder, kRemainder);
  require(table.rest_stderr, kStandardError);
  if (table.is_factored()) require_factors(table);
}

}  // namespace v1
}  // namespace sunbeam
