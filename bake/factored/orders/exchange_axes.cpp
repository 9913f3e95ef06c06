#include "bake/factored/orders/exchange_axes.h"

#include <algorithm>
#include <cmath>

#include "bake/factored/orders/stack_powers.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/quadrature.h"

namespace sunbeam {
namespace {

constexpr double kMostError = 1e-3;   // of V
constexpr double kSameAlbedo = 1e-6;  // as good as grey
constexpr std::size_t kLeastAlbedoNodes = 3, kMostAlbedoNodes = 16;
constexpr double kMiddleNm = 510;
constexpr std::size_t kDispersiveNodes = 5;
constexpr std::size_t kLeastFringeNodes = 6, kMostFringeNodes = 4096;
constexpr double kLeastNodesPerFringe = 3, kMostNodesPerFringe = 96;
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

// rho at these orders. Spread is left out, since it only smoothes.
std::vector<double> returned(const Film& film, std::span<const double> orders) {
  constexpr int kLeastCosines = 48, kCosinesPerOrder = 4;
  Material even = film.material;
  even.thickness_spread = 0;
  const StackSpectrum stack = stack_at_orders(even, film.one, orders);
  const GaussRule rule = gauss_legendre(
      kLeastCosines + static_cast<int>(kCosinesPerOrder * range_of({orders.begin(), orders.end()}).high));
  std::vector<double> above(stack.lanes()), through(stack.lanes()), below(stack.lanes()), sum(orders.size());
  for (int i = 0; i < rule.size(); ++i) {
    stack.powers(ior_of(even, Side::inside), std::sqrt(rule.node[i]), above.data(), through.data(),
                 below.data());
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += rule.weight[i] * below[j];
  }
  return sum;
}

double visits(double albedo, double returned) { return 1 / (1 - albedo * std::min(returned, 0.9999)); }

double interpolated(const Axis& axis, std::span<const double> values, double x) {
  const Stencil at = axis.stencil(x);
  double sum = 0;
  for (std::size_t i = 0; i < at.count; ++i) sum += at.weight[i] * values[at.node[i]];
  return sum;
}

// The largest relative error of V between nodes; `most_returned` grows to the largest rho.
double order_error(const Film& film, const Axis& orders, double albedo, double passing,
                   double& most_returned) {
  const std::vector<double> between = middles(orders);
  std::vector<double> v;
  for (const double rho : returned(film, orders.nodes)) {
    v.push_back(visits(albedo, passing * rho));
    most_returned = std::max(most_returned, passing * rho);
  }
  const std::vector<double> rho = returned(film, between);
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

Axis wavelengths_axis(const Wavelengths& w) {
  const Range range = range_of(w.nm);
  Axis axis{"wavelength_nm", "nm", {std::clamp(kMiddleNm, range.low, range.high)}};
  if (is_dispersive(w) && range.high > range.low)
    axis.nodes = spaced_nodes(range.low, range.high, kDispersiveNodes);
  return cubic(axis);
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
  axes.wavelength = wavelengths_axis(w);
  const Range range = orders_of(recipe, w);
  const double albedo = range_of(w.albedo).high, passing = std::exp(-least_depth),
               fringes = range.high - range.low;
  const std::vector<Film> films = films_of(recipe, axes.wavelength);
  double most_returned = 0;
  const auto per_fringe = [&](double nodes) { return static_cast<std::size_t>(std::ceil(fringes * nodes)); };
  const std::size_t most = std::clamp(per_fringe(kMostNodesPerFringe), kLeastFringeNodes, kMostFringeNodes);
  for (std::size_t steps = std::max(per_fringe(kLeastNodesPerFringe), kLeastFringeNodes);;
       steps += steps / 4) {
    axes.fringe_order = orders_axis(range, steps, recipe.material.thickness_spread > 0);
    double worst = 0;
    for (const Film& film : films)
      worst = std::max(worst, order_error(film, axes.fringe_order, albedo, passing, most_returned));
    if (worst <= kMostError || steps >= most) break;
  }
  axes.albedo = albedos_axis(w, most_returned);
  return axes;
}

}  // namespace sunbeam
