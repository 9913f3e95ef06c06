#include "bake/optics/layered/film_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sunbeam/detail/layered_film.h"

namespace sunbeam {
namespace {

// Steep edges and metals have more at the ends of the visible than fringes have.
constexpr NodeRange kWideRange{385, 760};

constexpr int kAngles = 33, kThicknesses = 8;

// How much thicker the film is at each further step.
constexpr double kStep = 1.4;

// What is to be folded: a film without spread.
struct Film {
  Material material;
  const FilmDesign& design;

  // Returns the folded reflectance from above at angles spaced evenly, all of them for each thickness.
  std::vector<Rgb> folded(const WavelengthQuadrature& quadrature,
                          const std::vector<double>& thicknesses_nm) const {
    Wavelengths wavelengths;
    wavelengths.nm = quadrature.wavelength_nm;
    design.fill(wavelengths);
    std::vector<Rgb> result;
    for (const double thickness : thicknesses_nm) {
      Material at = material;
      at.film_thickness_nm = thickness;
      const StackSpectrum film = stack_spectrum(at, wavelengths);
      std::vector<double> above(film.lanes()), through(film.lanes()), below(film.lanes());
      for (int angle = 0; angle < kAngles; ++angle) {
        const double cosine = std::cos(0.5 * kPi * (angle + 0.5) / kAngles);
        film.powers(at.exterior_ior, cosine, above.data(), through.data(), below.data());
        result.push_back(quadrature.fold(std::span(above).first(film.wavelengths())));
      }
    }
    return result;
  }
};

double folding_error(const std::vector<Rgb>& found, const std::vector<Rgb>& reference) {
  std::vector<double> errors;
  for (std::size_t k = 0; k < found.size(); ++k)
    for (int channel = 0; channel < 3; ++channel)
      errors.push_back(std::abs(found[k][channel] - reference[k][channel]) /
                       std::max(reference[k][channel], 0.01));
  const auto p99 =
      errors.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(errors.size() - 1));
  std::ranges::nth_element(errors, p99);
  return *p99;
}

bool is_good(double error) { return error <= kMostFoldingError; }

// Tries both ranges with so many nodes.
FilmNodes measured(const Film& film, Illuminant illuminant, ColorSpace space, int count,
                   const std::vector<double>& thicknesses_nm, const std::vector<Rgb>& exact) {
  FilmNodes nodes{};
  for (const NodeRange& range : {kNodeRange, kWideRange}) {
    nodes.quadrature =
        fitted(illuminant, space, count, resolved_path_nm(static_cast<std::size_t>(count)), range);
    nodes.error = folding_error(film.folded(nodes.quadrature, thicknesses_nm), exact);
    if (is_good(nodes.error)) break;
  }
  return nodes;
}

// Returns how thick the film may be, from a thickness for which the nodes are good.
double served_nm(const Film& film, const WavelengthQuadrature& nodes, const WavelengthQuadrature& reference,
                 double thickness_nm) {
  const double path_per_nm = film.design.path_nm(film.material, 1);
  const double resolved = path_per_nm > 0 ? resolved_path_nm(nodes.size()) / path_per_nm : 0;
  double served = std::max(thickness_nm, 1.0);
  while (served < resolved) {
    const double next = std::min(served * kStep, resolved);
    if (!is_good(folding_error(film.folded(nodes, {next}), film.folded(reference, {next})))) break;
    served = next;
  }
  return served;
}

}  // namespace

FilmNodes nodes_for_film(const Material& material, const FilmDesign& design, Illuminant illuminant,
                         ColorSpace space, double thickest_nm) {
  Film film{material, design};
  film.material.thickness_spread = 0;
  std::vector<double> thicknesses;
  for (int k = 1; k <= kThicknesses; ++k) thicknesses.push_back(thickest_nm * k / kThicknesses);
  const WavelengthQuadrature reference = brute_force(illuminant, space);
  const std::vector<Rgb> exact = film.folded(reference, thicknesses);
  int count = nodes_for_path(design.path_nm(material, thickest_nm));
  FilmNodes nodes = measured(film, illuminant, space, count, thicknesses, exact);
  while (!is_good(nodes.error) && count + 4 <= static_cast<int>(kMostWavelengths)) {
    count += 4;
    nodes = measured(film, illuminant, space, count, thicknesses, exact);
  }
  if (is_good(nodes.error))
    nodes.path_nm = design.path_nm(material, served_nm(film, nodes.quadrature, reference, thickest_nm));
  return nodes;
}

}  // namespace sunbeam
