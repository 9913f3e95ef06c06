#include "bake/optics/layered/film_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "bake/optics/layered/layered_film.h"

namespace sunbeam {
namespace {

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

std::vector<double> thicknesses_up_to(double thickest_nm) {
  std::vector<double> thicknesses;
  for (int k = 1; k <= kThicknesses; ++k) thicknesses.push_back(thickest_nm * k / kThicknesses);
  return thicknesses;
}

}  // namespace

FilmNodes nodes_for_film(const Material& material, const FilmDesign& design, Illuminant illuminant,
                         ColorSpace space, double thickest_nm) {
  Film film{material, design};
  film.material.thickness_spread = 0;
  const WavelengthQuadrature reference = brute_force(illuminant, space);
  const std::vector<double> thicknesses = thicknesses_up_to(thickest_nm);
  const std::vector<Rgb> exact = film.folded(reference, thicknesses);
  FilmNodes nodes{nodes_for_path(design.path_nm(material, thickest_nm)), 0, 0};
  WavelengthQuadrature quadrature;
  for (;; nodes.count += 4) {
    quadrature = fitted(illuminant, space, nodes.count, resolved_path_nm(nodes.count));
    nodes.error = folding_error(film.folded(quadrature, thicknesses), exact);
    if (nodes.error <= kMostFoldingError || nodes.count + 4 > static_cast<int>(kMostWavelengths)) break;
  }
  double served_nm = std::max(thickest_nm, 1.0);
  const double path_per_nm = design.path_nm(material, 1);
  const double resolved_nm = path_per_nm > 0 ? resolved_path_nm(nodes.count) / path_per_nm : 0;
  while (nodes.error <= kMostFoldingError && served_nm < resolved_nm) {
    const double next_nm = std::min(served_nm * kStep, resolved_nm);
    const double error = folding_error(film.folded(quadrature, {next_nm}), film.folded(reference, {next_nm}));
    if (error > kMostFoldingError) break;
    served_nm = next_nm;
  }
  nodes.path_nm = design.path_nm(material, served_nm);
  return nodes;
}

}  // namespace sunbeam
