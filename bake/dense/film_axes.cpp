#include "bake/dense/film_axes.h"

#include <algorithm>
#include <array>

#include "bake/base/error_floor.h"
#include "bake/dense/film_colors.h"
#include "sunbeam/detail/factor_frame.h"

namespace sunbeam {
namespace {

// Choices of the rad of film phase between thickness nodes, and of the number of cosines. The first ones
// serve every single film: cubic to 0.15 % of a fringe.
constexpr std::array kPhaseSteps{0.5, 0.25, 0.125, 0.0625};
constexpr std::array<std::size_t, 5> kCosines{65, 129, 257, 513, 1025};
constexpr std::size_t kFactorAboutKnee = 2;  // of the intervals between cosines

constexpr double kMostError = 0.002;        // of a layered film's reflectance between nodes, relative
constexpr double kLeastReflectance = 0.01;  // that an error is relative to
constexpr double kMostCells = (16 << 20) / (3.0 * sizeof(float));

struct Fineness {
  std::size_t thickness = 0, cosine = 0;  // number of the choice
};

Axis thickness_axis(const Recipe& recipe, std::size_t choice) {
  Axis axis = recipe.grid[0];
  axis.is_cubic = true;
  const double path = recipe.spectrum.film().path_nm(recipe.material, axis.high() - axis.low());
  const auto nm = recipe.spectrum.wavelengths(recipe.material).nm;
  const double phase = 2 * kPi * path / *std::min_element(nm.begin(), nm.end());
  if (axis.size() > 1)
    axis.nodes = spaced_nodes(axis.low(), axis.high(),
                              static_cast<std::size_t>(std::ceil(phase / kPhaseSteps[choice])) + 2);
  return axis;
}

Axis base_ior_axis(const Recipe& recipe) {
  Axis axis = recipe.grid[1];
  axis.is_cubic = true;
  return axis;
}

// Even, or about the critical angle of the one base IOR that lies below the exterior's.
Axis cosine_axis(const Recipe& recipe, std::size_t choice) {
  Axis axis{"cos_theta", "1", spaced_nodes(0, 1, kCosines[choice]), 1, 0, 0, true};
  if (!reaches_below(recipe)) return axis;
  axis.power = 2;
  axis.origin = critical_cosine(at_lowest_base_ior(recipe));
  axis.nodes = spaced_nodes(axis, 0, 1, kFactorAboutKnee * (kCosines[choice] - 1) + 1);
  return axis;
}

double between(const Axis& axis, std::size_t lower) {
  return axis.at_coordinate((axis.coordinate(axis.nodes[lower]) + axis.coordinate(axis.nodes[lower + 1])) /
                            2);
}

// Returns an interpolated reflectance's error, of nodes that `at` knows.
template <class At>
double relative_error(const Axis& axis, double x, const Rgb& exact, At at) {
  const Stencil stencil = axis.stencil(x);
  Rgb sum;
  for (std::size_t k = 0; k < stencil.count; ++k) sum += stencil.weight[k] * at(stencil.node[k]);
  return mean_abs(sum - exact) / std::max(mean(exact), kLeastReflectance);
}

double p99(std::vector<double> errors) {
  if (errors.empty()) return 0;
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(errors.size() - 1));
  std::ranges::nth_element(errors, at);
  return *at;
}

// Measures how far a layered film's reflectance is off halfway between nodes.
class FilmErrors {
 public:
  explicit FilmErrors(const Recipe& recipe)
      : recipe_(recipe), wavelengths_(recipe.spectrum.wavelengths(recipe.material)) {}

  double over_cosine(const Axis& cosine) const {
    std::vector<double> errors;
    for (const double thickness_nm : thicknesses())
      for (const double base_ior : base_iors()) {
        const FilmColors film = film_at(thickness_nm, base_ior);
        std::vector<Rgb> nodes;
        for (const double c : cosine.nodes) nodes.push_back(reflectance(film, c));
        for (std::size_t k = 0; k + 1 < cosine.size(); ++k) {
          const double c = between(cosine, k);
          errors.push_back(
              relative_error(cosine, c, reflectance(film, c), [&](std::size_t node) { return nodes[node]; }));
        }
      }
    return p99(std::move(errors));
  }

  double over_thickness(const Axis& thickness) const {
    constexpr std::size_t kIntervals = 48;  // at most, spread over the axis
    std::vector<double> errors;
    const std::size_t intervals = thickness.size() - 1, count = std::min(intervals, kIntervals);
    for (std::size_t i = 0; i < count; ++i)
      for (const double base_ior : base_iors())
        for (const double cosine : {0.1, 0.3, 0.5, 0.75, 1.0}) {
          const double nm = between(thickness, i * intervals / count);
          const auto at = [&](double x) { return reflectance(film_at(x, base_ior), cosine); };
          errors.push_back(relative_error(thickness, nm, at(nm),
                                          [&](std::size_t node) { return at(thickness.nodes[node]); }));
        }
    return p99(std::move(errors));
  }

 private:
  // Thick films have the most fringes over the cosine.
  std::vector<double> thicknesses() const {
    const Axis& axis = recipe_.grid[0];
    if (axis.size() == 1) return {axis.low()};
    return {lerp(0.6, axis.low(), axis.high()), lerp(0.8, axis.low(), axis.high()), axis.high()};
  }
  std::vector<double> base_iors() const {
    const Axis& axis = recipe_.grid[1];
    if (axis.size() == 1) return {axis.low()};
    return {axis.low(), axis.high()};
  }
  FilmColors film_at(double thickness_nm, double base_ior) const {
    Material material = recipe_.material;
    material.film_thickness_nm = thickness_nm;
    material.base_ior = base_ior;
    return {material, wavelengths_};
  }
  static Rgb reflectance(const FilmColors& film, double cosine) {
    return film.at(std::max(cosine, kLeastFilmCosine)).reflectance;
  }

  const Recipe& recipe_;
  Wavelengths wavelengths_;
};

// Returns the errors of the choices up to the first that is good enough.
template <class Error>
std::vector<double> errors_of(std::size_t choices, Error error) {
  std::vector<double> errors;
  while (errors.size() < choices && (errors.empty() || errors.back() > kMostError))
    errors.push_back(error(errors.size()));
  return errors;
}

std::size_t first_within(const std::vector<double>& errors, double allowed) {
  const auto good = std::ranges::find_if(errors, [&](double error) { return error <= allowed; });
  return static_cast<std::size_t>(std::min(good - errors.begin(), std::ssize(errors) - 1));
}

// Returns the coarsest axes within the error, or within the least multiple of it that the arrays have room
// for.
Fineness fineness_of(const Recipe& recipe) {
  const FilmErrors error(recipe);
  const auto of_thickness = errors_of(kPhaseSteps.size(), [&](std::size_t choice) {
    return error.over_thickness(thickness_axis(recipe, choice));
  });
  const auto of_cosine = errors_of(
      kCosines.size(), [&](std::size_t choice) { return error.over_cosine(cosine_axis(recipe, choice)); });
  for (double allowed = kMostError;; allowed *= 2) {
    const Fineness fineness{first_within(of_thickness, allowed), first_within(of_cosine, allowed)};
    const double cells =
        static_cast<double>(thickness_axis(recipe, fineness.thickness).size() * recipe.grid[1].size() *
                            cosine_axis(recipe, fineness.cosine).size());
    if (cells <= kMostCells || (fineness.thickness == 0 && fineness.cosine == 0)) return fineness;
  }
}

}  // namespace

std::vector<Axis> film_axes(const Recipe& recipe) {
  const Fineness fineness = is_layered(recipe) ? fineness_of(recipe) : Fineness();
  return {thickness_axis(recipe, fineness.thickness), base_ior_axis(recipe),
          cosine_axis(recipe, fineness.cosine)};
}

}  // namespace sunbeam
