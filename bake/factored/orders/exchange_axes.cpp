#include "bake/factored/orders/exchange_axes.h"

#include <algorithm>
#include <cmath>

#include "bake/factored/orders/stack_powers.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/quadrature.h"
#include "sunbeam/detail/refraction.h"

namespace sunbeam {
namespace {

constexpr double kMostError = 2e-3;   // of V
constexpr double kSameAlbedo = 1e-6;  // as good as grey
constexpr std::size_t kLeastAlbedoNodes = 3, kMostAlbedoNodes = 16;
constexpr double kMiddleNm = 510;
constexpr std::size_t kLeastDispersiveNodes = 2, kMostDispersiveNodes = 8;
constexpr std::size_t kLeastFringeNodes = 6, kMostFringeNodes = 4096;
constexpr double kLeastNodesPerFringe = 3, kMostNodesPerFringe = 32;
constexpr double kMostOrderOfSpread = 100;  // StackSpectrum takes no more

struct Range {
  double low, high;
};

Range range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

Axis cubic(Axis axis) {
  axis.is_cubic = axis.size() > 2;
  return axis;
}

// Fringe orders at normal incidence of all films and wavelengths.
Range orders_of(const Recipe& recipe, const Wavelengths& w) {
  std::vector<double> order;
  for (std::size_t k = 0; k < w.size(); ++k)
    for (const double thickness : {recipe.grid[0].low(), recipe.grid[0].high()})
      order.push_back(path_per_thickness(recipe.material, w, k) * thickness / w.nm[k]);
  return range_of(order);
}

// A cubic is best inside its nodes, so there is one more beyond the range.
Axis orders_axis(const Range& range, std::size_t steps, bool is_spread) {
  Axis axis{"fringe_order", "1", {range.low}};
  if (range.high > range.low) {
    const double beyond = range.high + (range.high - range.low) / static_cast<double>(steps);
    const double end = is_spread ? std::max(range.high, std::min(beyond, kMostOrderOfSpread)) : beyond;
    axis.nodes = spaced_nodes(range.low, end, steps + 2);
  }
  return cubic(axis);
}

std::vector<double> middles(const Axis& axis) {
  std::vector<double> x;
  for (std::size_t j = 0; j + 2 < axis.size(); ++j) x.push_back((axis.nodes[j] + axis.nodes[j + 1]) / 2);
  return x;
}

// One film of the recipe's, at a base IOR and a wavelength.
struct Film {
  Material material;
  Wavelengths one;
};

// Adds what the film sends back of diffuse light between two cosines of the medium of this index; `weight` is
// that medium's share in 2 m dm of the base.
void add_returned(const StackSpectrum& stack, const GaussRule& rule, double ior, double low, double high,
                  double weight, std::span<double> sum) {
  std::vector<double> above(stack.lanes()), through(stack.lanes()), below(stack.lanes());
  for (int i = 0; i < rule.size(); ++i) {
    const double cosine = lerp(rule.node[i], low, high);
    stack.powers(ior, cosine, above.data(), through.data(), below.data());
    for (std::size_t j = 0; j < sum.size(); ++j)
      sum[j] += weight * rule.weight[i] * (high - low) * 2 * cosine * below[j];
  }
}

// rho at these orders. Light that gets out is summed over its cosine outside, where the powers are smooth.
// Spread is left out, since it only smoothes.
std::vector<double> returned(const Film& film, const GaussRule& rule, std::span<const double> orders) {
  Material even = film.material;
  even.thickness_spread = 0;
  const StackSpectrum stack = stack_at_orders(even, film.one, orders);
  const double outside = even.exterior_ior, base = ior_of(even, Side::inside);
  const double critical = critical_cosine(base, outside);
  std::vector<double> sum(orders.size());
  if (critical > 0) {
    add_returned(stack, rule, base, 0, critical, 1, sum);
    add_returned(stack, rule, outside, 0, 1, square(outside / base), sum);
  } else {
    add_returned(stack, rule, base, 0, 1, 1, sum);
  }
  return sum;
}

// A rule with as many cosines as rho needs, which resonances between metals raise.
GaussRule resolving_rule(const std::vector<Film>& films, const Range& orders) {
  constexpr int kLeastCosines = 24, kMostCosines = 96, kTrials = 17;
  constexpr double kError = 2e-4;
  const auto trials = spaced_nodes(orders.low, orders.high, orders.high > orders.low ? kTrials : 1);
  for (int count = kLeastCosines;; count *= 2) {
    const GaussRule rule = gauss_legendre(count), finer = gauss_legendre(3 * count / 2);
    double worst = 0;
    for (const Film& film : films) {
      const auto rho = returned(film, rule, trials), better = returned(film, finer, trials);
      for (std::size_t j = 0; j < rho.size(); ++j) worst = std::max(worst, std::abs(rho[j] - better[j]));
    }
    if (worst <= kError || count >= kMostCosines) return rule;
  }
}

double visits(double albedo, double returned) { return 1 / (1 - albedo * std::min(returned, 0.9999)); }

double interpolated(const Axis& axis, std::span<const double> values, double x) {
  const Stencil at = axis.stencil(x);
  double sum = 0;
  for (std::size_t i = 0; i < at.count; ++i) sum += at.weight[i] * values[at.node[i]];
  return sum;
}

// The largest relative error of V between nodes; `most_returned` grows to the largest rho.
double order_error(const Film& film, const GaussRule& rule, const Axis& orders, double albedo, double passing,
                   double& most_returned) {
  const std::vector<double> between = middles(orders);
  std::vector<double> v;
  for (const double rho : returned(film, rule, orders.nodes)) {
    v.push_back(visits(albedo, passing * rho));
    most_returned = std::max(most_returned, passing * rho);
  }
  const std::vector<double> rho = returned(film, rule, between);
  double worst = 0;
  for (std::size_t j = 0; j < between.size(); ++j) {
    const double exact = visits(albedo, passing * rho[j]);
    worst = std::max(worst, std::abs(interpolated(orders, v, between[j]) / exact - 1));
  }
  return worst;
}

double albedo_error(const Axis& albedos, double returned) {
  std::vector<double> v;
  for (const double albedo : albedos.nodes) v.push_back(visits(albedo, returned));
  double worst = 0;
  for (std::size_t j = 0; j + 1 < albedos.size(); ++j) {
    const double albedo = (albedos.nodes[j] + albedos.nodes[j + 1]) / 2;
    worst = std::max(worst, std::abs(interpolated(albedos, v, albedo) / visits(albedo, returned) - 1));
  }
  return worst;
}

Axis albedos_axis(const Wavelengths& w, double returned) {
  const Range range = range_of(w.albedo);
  Axis axis{"albedo", "1", {range.low}};
  if (range.high - range.low <= kSameAlbedo) return axis;
  for (std::size_t count = kLeastAlbedoNodes; count <= kMostAlbedoNodes; ++count) {
    axis.nodes = spaced_nodes(range.low, range.high, count);
    axis = cubic(axis);
    if (albedo_error(axis, returned) <= kMostError) break;
  }
  return axis;
}

Film film_at(const Recipe& recipe, double nm) {
  return {recipe.material, recipe.spectrum.monochromatic(recipe.material, nm)};
}

// The largest relative error of V between wavelengths, at some orders.
double wavelength_error(const Recipe& recipe, const Axis& wavelengths, std::span<const double> orders,
                        double albedo) {
  const GaussRule rule = gauss_legendre(24);
  std::vector<std::vector<double>> rho;
  for (const double nm : wavelengths.nodes) rho.push_back(returned(film_at(recipe, nm), rule, orders));
  double worst = 0;
  for (std::size_t k = 0; k + 1 < wavelengths.size(); ++k) {
    const double nm = (wavelengths.nodes[k] + wavelengths.nodes[k + 1]) / 2;
    const auto exact = returned(film_at(recipe, nm), rule, orders);
    for (std::size_t j = 0; j < orders.size(); ++j) {
      std::vector<double> v;
      for (const std::vector<double>& at_node : rho) v.push_back(visits(albedo, at_node[j]));
      worst = std::max(worst, std::abs(interpolated(wavelengths, v, nm) / visits(albedo, exact[j]) - 1));
    }
  }
  return worst;
}

Axis wavelengths_axis(const Recipe& recipe, const Wavelengths& w, const Range& orders, double albedo) {
  constexpr std::size_t kOrders = 33;
  const Range range = range_of(w.nm);
  Axis axis{"wavelength_nm", "nm", {std::clamp(kMiddleNm, range.low, range.high)}};
  if (!is_dispersive(w) || range.high == range.low) return axis;
  const auto trials = spaced_nodes(orders.low, orders.high, orders.high > orders.low ? kOrders : 1);
  for (std::size_t count = kLeastDispersiveNodes; count <= kMostDispersiveNodes; ++count) {
    axis.nodes = spaced_nodes(range.low, range.high, count);
    axis = cubic(axis);
    if (wavelength_error(recipe, axis, trials, albedo) <= kMostError) break;
  }
  return axis;
}

// The films at the ends of the axes.
std::vector<Film> films_of(const Recipe& recipe, const Axis& wavelengths) {
  std::vector<Film> films;
  for (const double ior : {recipe.grid[1].low(), recipe.grid[1].high()})
    for (const double nm : {wavelengths.low(), wavelengths.high()}) {
      Material material = recipe.material;
      material.base_ior = ior;
      films.push_back({material, recipe.spectrum.monochromatic(recipe.material, nm)});
    }
  return films;
}

}  // namespace

bool is_dispersive(const Wavelengths& w) {
  const auto differ = [](const auto& list) {
    return std::ranges::any_of(list, [&](const auto& entry) {
      if constexpr (requires { entry.size(); })
        return !std::ranges::equal(entry, list.front(), {}, &FilmLayer::index, &FilmLayer::index);
      else
        return entry != list.front();
    });
  };
  return differ(w.layers) || differ(w.base_index);
}

ExchangeAxes exchange_axes(const Recipe& recipe, const Wavelengths& w, double least_depth) {
  ExchangeAxes axes;
  const Range range = orders_of(recipe, w);
  const double albedo = range_of(w.albedo).high, passing = std::exp(-least_depth),
               fringes = range.high - range.low;
  axes.wavelength = wavelengths_axis(recipe, w, range, albedo);
  const std::vector<Film> films = films_of(recipe, axes.wavelength);
  const GaussRule rule = resolving_rule(films, range);
  double most_returned = 0;
  const auto per_fringe = [&](double nodes) { return static_cast<std::size_t>(std::ceil(fringes * nodes)); };
  const std::size_t most = std::clamp(per_fringe(kMostNodesPerFringe), kLeastFringeNodes, kMostFringeNodes);
  for (std::size_t steps = std::max(per_fringe(kLeastNodesPerFringe), kLeastFringeNodes);;
       steps += steps / 4) {
    axes.fringe_order = orders_axis(range, steps, recipe.material.thickness_spread > 0);
    double worst = 0;
    for (const Film& film : films)
      worst = std::max(worst, order_error(film, rule, axes.fringe_order, albedo, passing, most_returned));
    if (worst <= kMostError || steps >= most) break;
  }
  axes.albedo = albedos_axis(w, most_returned);
  return axes;
}

}  // namespace sunbeam
