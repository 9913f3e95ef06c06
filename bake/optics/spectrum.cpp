#include "bake/optics/spectrum.h"

#include <algorithm>
#include <cmath>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

// Every thin film takes all the path that its number of nodes resolves.
WavelengthQuadrature quadrature_for(Illuminant illuminant, ColorSpace color_space, double longest_path_nm) {
  const int nodes = nodes_for_path(longest_path_nm);
  if (static_cast<std::size_t>(nodes) > kMostWavelengths)
    throw Error("spectrum: found an optical path 2 n1 d0 of " + to_text(longest_path_nm) +
                " nm; allowed: up to " + to_text(resolved_path_nm(kMostWavelengths)) + " nm");
  return fitted(illuminant, color_space, nodes, resolved_path_nm(nodes));
}

}  // namespace

Spectrum::Spectrum(Illuminant illuminant, ColorSpace color_space, double longest_path_nm,
                   AbsorptionShape absorption)
    : Spectrum(illuminant, color_space, quadrature_for(illuminant, color_space, longest_path_nm),
               std::move(absorption)) {}

Spectrum::Spectrum(Illuminant illuminant, ColorSpace color_space, WavelengthQuadrature quadrature,
                   AbsorptionShape absorption)
    : illuminant_(illuminant),
      color_space_(color_space),
      quadrature_(std::move(quadrature)),
      served_path_nm_(resolved_path_nm(quadrature_.size())),
      absorption_(std::move(absorption)) {}

void Spectrum::set_film(FilmDesign film, double served_path_nm) {
  film_ = std::move(film);
  served_path_nm_ = std::min(served_path_nm, resolved_path_nm(quadrature_.size()));
}

Rgb Spectrum::from_rec709(const Rgb& color) const {
  if (color_space_ == ColorSpace::rec709) return color;
  return rgb_to_rgb(ColorSpace::rec709, color_space_) * color;
}

Rgb Spectrum::set_albedo(const SpectralCurve& albedo) {
  const Rgb folded = quadrature_.fold_function([&](double nm) { return interpolate(albedo, nm); });
  albedo_ = transform(folded, [](double x) { return std::clamp(x, 0.0, 1.0); });
  albedo_curve_ = albedo;
  return albedo_;
}

void Spectrum::set_albedo(const Rgb& albedo) {
  albedo_curve_ = albedo_curve(albedo);
  albedo_ = albedo;
}

SpectralCurve Spectrum::albedo_curve(const Rgb& albedo) const {
  if (!albedo_curve_.empty() && albedo == albedo_) return albedo_curve_;
  const std::vector<double> uplifted = uplift_albedo(quadrature_, albedo);
  SpectralCurve curve;
  for (std::size_t k = 0; k < uplifted.size(); ++k)
    curve.emplace_back(quadrature_.wavelength_nm[k], uplifted[k]);
  std::sort(curve.begin(), curve.end());
  return curve;
}

void Spectrum::require_served(const Material& material) const {
  if (!film_.reaches(material.film_thickness_nm))
    throw Error("key 'film_thickness_nm': found " + to_text(material.film_thickness_nm) +
                ", but all layers of the film are 0 nm thick; allowed: 0");
  if (is_full()) require_path(material, served_path_nm_, "; grid.film_thickness_nm in the recipe raises it");
}

void Spectrum::require_path(const Material& material, double longest_nm, const std::string& remedy) const {
  if (film_.path_nm(material, material.film_thickness_nm) <= longest_nm) return;
  throw Error("key 'film_thickness_nm': found " + to_text(material.film_thickness_nm) +
              "; the wavelengths of the recipe resolve films up to " +
              to_text(std::floor(longest_nm / film_.path_nm(material, 1))) + " nm" + remedy);
}

Wavelengths Spectrum::with_film(const Material& material, Wavelengths wavelengths) const {
  film_.fill(wavelengths);
  if (film_.is_layered(material)) require_path(material, resolved_path_nm(kMostWavelengths), "");
  return wavelengths;
}

Wavelengths Spectrum::full_wavelengths(const Material& material) const {
  const SpectralCurve albedo = albedo_curve(material.albedo);
  Wavelengths w;
  w.nm = quadrature_.wavelength_nm;
  w.weight = quadrature_.weight;
  for (const double nm : w.nm) {
    w.albedo.push_back(interpolate(albedo, nm));
    w.absorption.push_back(absorption_(nm));
  }
  return w;
}

Wavelengths Spectrum::wavelengths(const Material& material) const {
  require_served(material);
  return with_film(material, is_full() ? full_wavelengths(material) : Wavelengths::rgb3(material));
}

Wavelengths Spectrum::monochromatic(const Material& material, double nm) const {
  Wavelengths w = Wavelengths::monochromatic(material, nm);
  if (is_full()) {
    w.albedo = {interpolate(albedo_curve(material.albedo), nm)};
    w.absorption = {absorption_(nm)};
  }
  return with_film(material, std::move(w));
}

std::map<std::string, std::string> Spectrum::attributes() const {
  if (!is_full()) return {{"spectrum", "rgb3"}};
  std::vector<double> nm = quadrature_.wavelength_nm;
  std::sort(nm.begin(), nm.end());
  return {{"spectrum", "full"},
          {"color_space", std::string(to_string(color_space_))},
          {"illuminant", std::string(to_string(illuminant_))},
          {"wavelengths", to_text(nm)}};
}

}  // namespace sunbeam
