#include "runtime/src/layers/layered_waves.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sunbeam/detail/factors.h"
#include "sunbeam/detail/refraction.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kMostLogShare = 2;  // at 0 all light gets to the base, and interpolation errs by little

// By how many fringes the film's powers differ between normal incidence and grazing, at the wavelength that
// has most.
double fringes_over_cosines(const Material& material, const Wavelengths& waves) {
  double most = 0;
  for (std::size_t k = 0; k < waves.size(); ++k) {
    const FilmStack film = film_stack(material, waves, k);
    double path = 0;
    for (const FilmLayer& layer : film.layers) {
      const double squared = refracted_cosine_squared(film.exterior_ior, layer.index.real(), 0);
      path += 2 * layer.index.real() * layer.thickness_nm * (1 - std::sqrt(std::max(squared, 0.0)));
    }
    most = std::max(most, path * film.periods / waves.nm[k]);
  }
  return most;
}

// Nodes of one quadrature. Powers swing by the fringes.
int node_count(double fringes) {
  constexpr double kLeast = 24, kPerFringe = 10, kMost = 400;
  return static_cast<int>(std::min(kLeast + kPerFringe * fringes, kMost));
}

// Takes a row over the axis to x.
double interpolated(std::span<const double> row, const Stencil& at) {
  double sum = 0;
  for (std::size_t i = 0; i < at.count; ++i) sum += at.weight[i] * row[at.node[i]];
  return sum;
}

// Returns the rank at which cosines that grow along the axis pass `cosine`.
double rank_of(const Axis& axis, std::span<const double> cosines, double cosine) {
  constexpr int kBisections = 40;
  double low = 0, high = 1;
  for (int i = 0; i < kBisections; ++i) {
    const double rank = (low + high) / 2;
    (interpolated(cosines, axis.stencil(rank)) < cosine ? low : high) = rank;
  }
  return (low + high) / 2;
}

}  // namespace

// Nodes over the rank, with dv in their weight.
struct LayeredWaves::Nodes {
  std::vector<double> rank, weight;

  // From the rank u0 to u1, dense towards a knee at u0: powers behave like a root of the distance there.
  void add(const GaussRule& rule, double u0, double u1) {
    for (int i = 0; i < rule.size(); ++i) {
      const double s = rule.node[i];
      rank.push_back(lerp(s * s, u0, u1));
      weight.push_back(rule.weight[i] * 2 * s * std::abs(u1 - u0) * share_slope(rank.back()));
    }
  }
};

LayeredWaves::LayeredWaves(const Table& table, const Material& material)
    : table_(table),
      waves_(table.factors.wavelengths),
      material_(material),
      curves_(material, waves_, FilmCurves::kTable),
      rule_(gauss_legendre(node_count(fringes_over_cosines(material, waves_)))),
      every_wavelength_(waves_.size()) {
  std::iota(every_wavelength_.begin(), every_wavelength_.end(), 0);
  if (material.is_opaque()) return;
  if (!table.factors.crossing.empty()) take_crossing(table.factors.crossing);
  if (!table.factors.returning.empty()) take_returns();
}

// From (base_ior, optical_depth, theta, phi, facet_rank) at this base IOR.
void LayeredWaves::take_crossing(const NdArray& crossing) {
  const NdArray slice = crossing.slice(std::array{material_.base_ior});
  const std::size_t depths = slice.axes()[0].size(), ranks = slice.axes()[3].size();
  const std::size_t directions = slice.axes()[1].size() * slice.axes()[2].size();
  for (std::size_t w = 0; w < directions; ++w)
    for (std::size_t t = 0; t < depths; ++t)
      for (std::size_t j = 0; j < ranks; ++j)
        crossing_.push_back(double{slice.values()[t * slice.stride(0) + w * ranks + j]});
}

// What is reflected totally ends at a knee.
void LayeredWaves::take_returns() {
  const NdArray& array = table_.factors.return_cosine;
  const Axis& axis = array.axes()[0];
  const std::vector<double> cosines(array.values().begin(), array.values().end());
  const bool bends = material_.transmission == Transmission::refract;
  const double critical = bends ? critical_cosine(material_.base_ior, material_.exterior_ior)
                                : critical_cosine(material_.exterior_ior, material_.base_ior);
  const double knee = critical > 0 ? rank_of(axis, cosines, critical) : 0;
  Nodes nodes;
  nodes.add(rule_, knee, 1);
  if (knee > 0) nodes.add(rule_, knee, 0);
  FilmPowers powers;
  for (const double rank : nodes.rank) {
    return_place_.push_back(axis.stencil(rank));
    const double cosine = std::clamp(interpolated(cosines, return_place_.back()), 0.0, 1.0);
    curves_.at(Side::inside, cosine, every_wavelength_, powers);
    reflectance_.insert(reflectance_.end(), powers.reflectance.begin(), powers.reflectance.begin() + size());
  }
  return_weight_ = std::move(nodes.weight);
}

Rgb LayeredWaves::reflectance(double cosine) const {
  std::array<double, kMostWavelengths> values;
  reflectance(cosine, values);
  return waves_.fold(std::span(values).first(size()));
}

void LayeredWaves::reflectance(double cosine, std::span<double> values) const {
  FilmPowers powers;
  curves_.at(Side::outside, cosine, every_wavelength_, powers);
  std::copy_n(powers.reflectance.begin(), size(), values.begin());
}

void LayeredWaves::let_pass(double cosine, double* transmittance) const {
  FilmPowers powers;
  curves_.at(Side::outside, cosine, every_wavelength_, powers);
  std::copy_n(powers.transmittance.begin(), size(), transmittance);
}

LayeredWaves::Passage LayeredWaves::passage(double cosine, double phi) const {
  Passage w;
  w.per_pigment_cosine = 1 / crossing_cosine(material_, cosine);
  if (crossing_.empty()) {
    w.weight = {1};
    w.transmittance.resize(size());
    let_pass(cosine, w.transmittance.data());
    return w;
  }
  const NdArray& facets = table_.factors.facet_cosine;
  const std::vector<Axis>& axes = facets.axes();
  const std::size_t ranks = axes[2].size(), row = crossing_.size() / (facets.cells() / ranks);
  const Stencil theta = axes[0].stencil(std::acos(std::min(cosine, 1.0))), azimuth = axes[1].stencil(phi);
  std::vector<double> cosines(ranks), crossing(row);
  for (std::size_t a = 0; a < theta.count; ++a)
    for (std::size_t b = 0; b < azimuth.count; ++b) {
      const std::size_t direction = theta.node[a] * axes[1].size() + azimuth.node[b];
      const double weight = theta.weight[a] * azimuth.weight[b];
      for (std::size_t j = 0; j < ranks; ++j)
        cosines[j] += weight * double{facets.values()[direction * ranks + j]};
      for (std::size_t j = 0; j < row; ++j) crossing[j] += weight * crossing_[direction * row + j];
    }
  add_nodes(axes[2], cosines, crossing, w);
  return w;
}

// The film lets nothing in below the critical angle's cosine.
void LayeredWaves::add_nodes(const Axis& ranks, std::span<const double> cosines,
                             std::span<const double> crossing, Passage& w) const {
  const double critical = critical_cosine(material_.exterior_ior, material_.base_ior);
  Nodes nodes;
  nodes.add(rule_, critical > 0 ? rank_of(ranks, cosines, critical) : 0, 1);
  const std::size_t count = nodes.rank.size(), depths = crossing.size() / ranks.size();
  w.weight = std::move(nodes.weight);
  w.transmittance.resize(count * size());
  w.crossing.resize(depths * count);
  for (std::size_t j = 0; j < count; ++j) {
    const Stencil at = ranks.stencil(nodes.rank[j]);
    let_pass(std::clamp(interpolated(cosines, at), 0.0, 1.0), &w.transmittance[j * size()]);
    for (std::size_t t = 0; t < depths; ++t)
      w.crossing[t * count + j] = interpolated(crossing.subspan(t * ranks.size(), ranks.size()), at);
  }
}

void LayeredWaves::arriving(const Passage& w, double optical_depth, std::span<double> share) const {
  const std::size_t count = w.weight.size();
  std::vector<double> weight(count);
  for (std::size_t k = 0; k < size(); ++k) {
    const double depth = optical_depth * waves_.absorption[k];
    if (k == 0 || waves_.absorption[k] != waves_.absorption[k - 1]) {
      const Stencil at = crossing_.empty() ? Stencil{} : table_.factors.crossing.axes()[1].stencil(depth);
      for (std::size_t j = 0; j < count; ++j) {
        double log_share = 0;
        for (std::size_t t = 0; t < at.count && !crossing_.empty(); ++t)
          log_share += at.weight[t] * w.crossing[at.node[t] * count + j];
        weight[j] = w.weight[j] * std::exp(std::min(log_share - depth * w.per_pigment_cosine, kMostLogShare));
      }
    }
    share[k] = 0;
    for (std::size_t j = 0; j < count; ++j) share[k] += weight[j] * w.transmittance[j * size() + k];
  }
}

double LayeredWaves::returned(std::size_t k, double optical_depth) const {
  if (return_weight_.empty()) return 0;
  const NdArray slice = table_.factors.returning.slice(std::array{optical_depth * waves_.absorption[k]});
  double sum = 0;
  for (std::size_t j = 0; j < return_weight_.size(); ++j) {
    const Stencil& at = return_place_[j];
    double returning = 0;
    for (std::size_t i = 0; i < at.count; ++i) returning += at.weight[i] * double{slice.values()[at.node[i]]};
    sum += return_weight_[j] * returning * reflectance_[j * size() + k];
  }
  return sum;
}

}  // namespace v1
}  // namespace sunbeam
