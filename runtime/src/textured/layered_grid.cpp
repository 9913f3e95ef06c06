#include "runtime/src/textured/layered_grid.h"

#include <cmath>

#include "runtime/src/base/color4.h"
#include "runtime/src/textured/resolved_axis.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/film_curves.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kMostCosines = 257, kLeastCosines = 33;
constexpr int kPhis = 7, kPhiStep = 3;  // of an anisotropic film
constexpr int kAbsorptions = 12;
constexpr int kThicknesses = 8, kMostThicknesses = 512;  // intervals
constexpr int kBaseIors = 8, kMostBaseIors = 16;
constexpr double kPerFringe = 2;        // intervals to begin with, of the shortest wavelength
constexpr double kMostError = 1e-3;     // between nodes, of what the film reflects and lets through
constexpr double kMostFilmBytes = 8e6;  // of R, and of P
constexpr double kMostPairBytes = 12e6, kMostPairBytesByAbsorption = 6e6;  // look-ups read twice as many
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr double kMostSeconds = 1;
#else
constexpr double kMostSeconds = 300;
#endif
constexpr std::size_t kExchangeDirections = 5;  // the first axis of a direction in `exchange`

std::size_t layers_of(const Wavelengths& w) {
  const std::size_t of_period = w.layers.empty() ? 1 : w.layers.front().size();
  return of_period * static_cast<std::size_t>(std::max(w.film_periods, 1));
}

// Cells of an array at fixed places on the axes before this one.
double cells_from(const NdArray& array, std::size_t axis) {
  return array.empty() ? 0 : static_cast<double>(axis == 0 ? array.cells() : array.stride(axis - 1));
}

// About how many seconds the arrays take at one thickness and base IOR.
double seconds_a_point(const Table& table, double absorptions, double phis) {
  constexpr double kDirections = 300, kPlatelets = 30, kPassages = 100, kCorners = 256;
  constexpr double kPerLayer = 3e-8, kPerCell = 3e-9;
  const Factors& factors = table.factors;
  const double waves = static_cast<double>(factors.wavelengths.size()),
               depths = factors.crossing.empty() ? 0 : static_cast<double>(factors.crossing.axes()[1].size());
  const double film = kDirections * waves * static_cast<double>(layers_of(factors.wavelengths)) *
                      (table.material.thickness_spread > 0 ? kPlatelets : 1);
  const double facets =
      cells_from(factors.crossing, 0) + kPassages * phis * depths * cells_from(factors.crossing, 4);
  const double visits =
      absorptions * waves *
      (cells_from(factors.returning, 1) + kCorners * cells_from(factors.exchange, kExchangeDirections));
  return kPerLayer * film + kPerCell * (facets + visits);
}

// A small file can describe a film that takes hours.
void require_reasonable_time(double points, const Table& table, double absorptions, double phis) {
  const double seconds = points * seconds_a_point(table, absorptions, phis);
  if (seconds <= kMostSeconds) return;
  throw Error("textured look-ups of films of " + std::to_string(layers_of(table.factors.wavelengths)) +
              " layers up to " + to_text(table.factors.grid[0].high()) + " nm take about " +
              to_text(std::ceil(seconds)) + " s to prepare; allowed: up to " + to_text(kMostSeconds) + " s");
}

// What the film reflects and lets through at some directions, folded: three numbers a direction of the first,
// then of the second.
Sampled film_at(const Table& table, double thickness_nm, double base_ior) {
  const Wavelengths& w = table.factors.wavelengths;
  Material material = table.material;
  material.film_thickness_nm = thickness_nm;
  material.base_ior = base_ior;
  const StackSpectrum film = stack_spectrum(material, w, FilmCurves::kTable.spread_orders);
  Sampled reflected, passing;
  for (const double cosine : {0.15, 0.4, 0.65, 0.85, 1.0}) {
    std::array<double, kMostWavelengths> above, through, below;
    film.powers(material.exterior_ior, cosine, above.data(), through.data(), below.data());
    const Rgb r = w.fold(std::span(above).first(w.size())), t = w.fold(std::span(through).first(w.size()));
    reflected.insert(reflected.end(), {r.r, r.g, r.b});
    passing.insert(passing.end(), {t.r, t.g, t.b});
  }
  reflected.insert(reflected.end(), passing.begin(), passing.end());
  return reflected;
}

// The difference of sums over the values of one quantity, relative.
double error_of(const Sampled& expected, const Sampled& found, std::size_t first, double floor) {
  double difference = 0, sum = 0;
  for (std::size_t k = first; k < first + expected.size() / 2; ++k) {
    difference += std::abs(expected[k] - found[k]);
    sum += std::abs(expected[k]);
  }
  return difference / std::max(sum, floor * static_cast<double>(expected.size() / 2));
}
double film_error(const Sampled& expected, const Sampled& found) {
  constexpr double kFaintReflection = 0.05, kFaintPassing = 0.005;
  return std::max(error_of(expected, found, 0, kFaintReflection),
                  error_of(expected, found, expected.size() / 2, kFaintPassing));
}

int first_thicknesses(const Table& table) {
  const Wavelengths& w = table.factors.wavelengths;
  const Axis& axis = table.factors.grid[0];
  double fringes = 0;
  for (std::size_t k = 0; k < w.size(); ++k)
    fringes =
        std::max(fringes, (axis.high() - axis.low()) * path_per_thickness(table.material, w, k) / w.nm[k]);
  require_reasonable_time(kPerFringe * fringes, table, 1, 1);
  return std::max(kThicknesses, static_cast<int>(std::ceil(kPerFringe * fringes)));
}

Axis thickness_axis(const Table& table) {
  const Axis& base_ior = table.factors.grid[1];
  const int first = first_thicknesses(table);
  Axis axis = table.factors.grid[0];
  axis.power = 1;  // as fringes are
  axis.is_cubic = true;
  return resolved_axis(
      axis, first, std::max(first, kMostThicknesses), kMostError,
      [&](double nm) { return film_at(table, nm, base_ior.low()); }, film_error);
}

Axis base_ior_axis(const Table& table) {
  const Axis& thickness = table.factors.grid[0];
  Axis axis = table.factors.grid[1];
  axis.is_cubic = false;
  return resolved_axis(
      axis, kBaseIors, kMostBaseIors, kMostError,
      [&](double base_ior) { return film_at(table, thickness.high(), base_ior); }, film_error);
}

Axis absorption_axis(const Table& table) {
  Axis axis = table.factors.grid[2];
  axis.is_cubic = false;
  if (axis.size() == 1) return axis;
  const EvenAxis even(axis, kAbsorptions);
  axis.nodes.clear();
  for (int k = 0; k < kAbsorptions; ++k) axis.nodes.push_back(even.node(k));
  return axis;
}

EvenAxis even_axis(Axis range, const Axis& nodes) {
  range.power = nodes.power;
  return EvenAxis(range, std::max<int>(2, static_cast<int>(nodes.size())));
}

double bytes_of(std::size_t cells) { return static_cast<double>(cells) * sizeof(Color4); }

}  // namespace

LayeredGrid::LayeredGrid(const Table& table)
    : axes{thickness_axis(table), base_ior_axis(table), absorption_axis(table)},
      even{even_axis(table.factors.grid[0], axes[0]), even_axis(table.factors.grid[1], axes[1]),
           even_axis(table.factors.grid[2], axes[2])},
      has_rest(!table.material.is_opaque()),
      is_product(has_rest && !table.factors.exchange.empty()),
      has_knee(has_rest && reaches_below(table)),
      exterior_ior(table.material.exterior_ior),
      cosines(kMostCosines),
      phis(table.symmetry == Symmetry::isotropic ? 1 : kPhis) {
  require_reasonable_time(points(), table, absorptions(), phis);
  fit_memory();
}

// Takes fewer directions where parameters take the room.
void LayeredGrid::fit_memory() {
  while (cosines > kLeastCosines && bytes_of(std::max(film_cells(), share_cells())) > kMostFilmBytes)
    cosines = (cosines - 1) / 2 + 1;
  if (phis > 1) phi_step = kPhiStep;
  for (const int step : {1, 2, 4, 6, 8}) {
    cosine_step = step;
    if (bytes_of(pair_cells()) <= (absorptions() == 1 ? kMostPairBytes : kMostPairBytesByAbsorption)) break;
  }
  const double bytes = bytes_of(film_cells() + share_cells() + log_cells() + pair_cells()),
               most = static_cast<double>(4 * read_limit(0));
  if (bytes > most)
    throw Error("textured look-ups of films up to " + to_text(axes[0].high()) + " nm take " +
                to_text(std::ceil(bytes / 1e6)) + " MB of memory; allowed: up to " + to_text(most / 1e6) +
                " MB");
}

Parameters LayeredGrid::parameters(int point, int absorption) const {
  const std::size_t iors = axes[1].size(), k = static_cast<std::size_t>(point);
  return {axes[0].nodes[k / iors], axes[1].nodes[k % iors],
          axes[2].nodes[static_cast<std::size_t>(absorption)]};
}

}  // namespace v1
}  // namespace sunbeam
