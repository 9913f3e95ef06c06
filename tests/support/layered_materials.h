// Designs of films beyond one clear layer, and materials that wear them at the paper's three wavelengths.
#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/configurations.h"

namespace sunbeam::test {

// A film and the base that it lies on. Both may depend on the wavelength, nm.
struct LayeredDesign {
  std::string name;
  std::function<std::vector<FilmLayer>(double)> layers;  // of one period, from top to bottom
  int periods = 1;
  std::function<std::complex<double>(double)> base{};  // none: what the material says
  double spread = 0;
};

// An index of Cauchy's, n = a + b / lambda^2 with lambda in micrometres.
inline double cauchy(double a, double b, double nm) { return a + b * 1e6 / (nm * nm); }

inline LayeredDesign clear_design() {
  return {"clear", [](double) { return std::vector<FilmLayer>{{60, 2.2}, {90, 1.4}}; }, 2};
}
inline LayeredDesign uneven_design() {
  LayeredDesign design = clear_design();
  design.name = "uneven";
  design.spread = 0.2;
  return design;
}
inline LayeredDesign dispersive_design() {
  return {"dispersive",
          [](double nm) {
            return std::vector<FilmLayer>{{80, cauchy(1.7, 0.02, nm)}, {110, cauchy(1.33, 0.004, nm)}};
          },
          2, [](double nm) { return std::complex<double>(cauchy(1.25, 0.01, nm)); }};
}
// Chitin and melanin, which absorbs more at short wavelengths.
inline LayeredDesign absorbing_design() {
  return {"absorbing",
          [](double nm) {
            return std::vector<FilmLayer>{{90, 1.56}, {70, {1.7, 0.06 * 510 / nm}}};
          },
          2};
}
inline LayeredDesign uneven_absorbing_design() {
  LayeredDesign design = absorbing_design();
  design.name = "uneven absorbing";
  design.spread = 0.15;
  return design;
}
// A thin metal under a dark layer: from above it absorbs most, from below it reflects.
inline LayeredDesign leaf_design() {
  return {"leaf", [](double) { return std::vector<FilmLayer>{{40, {1.9, 0.5}}, {14, {0.3, 3}}}; }};
}
// So much metal that about nothing comes through.
inline LayeredDesign mirror_design() {
  return {"mirror", [](double) { return std::vector<FilmLayer>{{300, {0.06, 3.5}}}; }};
}
// An oxide on a metal.
inline LayeredDesign oxide_design() {
  return {"oxide",
          [](double) {
            return std::vector<FilmLayer>{{120, 2.4}};
          },
          1, [](double nm) { return std::complex<double>(cauchy(1.6, 0.2, nm), 2.9); }};
}
// A dark oxide of uneven thickness: what it does not reflect is absorbed in it or below.
inline LayeredDesign dark_oxide_design() {
  return {"dark oxide",
          [](double) {
            return std::vector<FilmLayer>{{60, {2.3, 0.2}}, {30, 1.5}};
          },
          2, [](double) { return std::complex<double>(0.3, 3.5); }, 0.1};
}

inline std::vector<LayeredDesign> clear_designs() {
  return {clear_design(), uneven_design(), dispersive_design()};
}
inline std::vector<LayeredDesign> absorbing_designs() {
  return {absorbing_design(), uneven_absorbing_design(), leaf_design()};
}
inline std::vector<LayeredDesign> opaque_designs() { return {oxide_design(), dark_oxide_design()}; }

// The wavelengths with this film at each.
inline Wavelengths layered(const LayeredDesign& design, Wavelengths w) {
  w.film_periods = design.periods;
  for (const double nm : w.nm) {
    w.layers.push_back(design.layers(nm));
    if (design.base) w.base_index.push_back(design.base(nm));
  }
  return w;
}

// The material with this film. Over an opaque base it has no pigment.
inline Configuration with_film(const LayeredDesign& design, const NamedMaterial& bare) {
  Material m = bare.material;
  m.film_thickness_nm = 0;
  for (const FilmLayer& layer : design.layers(510))
    m.film_thickness_nm += design.periods * layer.thickness_nm;
  m.thickness_spread = design.spread;
  if (design.base) {
    m.base_ior = design.base(510).real();
    m.base_extinction = design.base(510).imag();
  }
  if (m.is_opaque()) {
    m.albedo = Rgb(0);
    m.absorption_per_nm = m.scattering_per_nm = 0;
  }
  return {design.name + " " + bare.name, m, layered(design, Wavelengths::rgb3(m))};
}

inline std::vector<Configuration> with_films(const std::vector<LayeredDesign>& designs,
                                             const std::vector<NamedMaterial>& materials) {
  std::vector<Configuration> result;
  for (const LayeredDesign& design : designs)
    for (const NamedMaterial& material : materials) result.push_back(with_film(design, material));
  return result;
}

// The same material at one of its wavelengths alone.
inline Wavelengths at_one(const Wavelengths& all, std::size_t k) {
  Wavelengths one{{all.nm[k]}, {all.albedo[k]}, {all.absorption[k]}, {Rgb(1)}};
  one.film_periods = all.film_periods;
  if (!all.layers.empty()) one.layers = {all.layers[k]};
  if (!all.base_index.empty()) one.base_index = {all.base_index[k]};
  return one;
}

// Surfaces that films lie on: smooth, rough with single facets and with multiple ones, each straight,
// refracting, and under a liquid denser than the base. Clear over `albedo`, unless `optical_depth` > 0.
inline std::vector<NamedMaterial> film_surfaces(const Rgb& albedo, double optical_depth = 0,
                                                const Roughness& roughness = 0.3) {
  struct Surface {
    const char* name;
    Roughness roughness;
    Microfacet microfacet;
  };
  struct Passing {
    const char* name;
    Transmission transmission;
    double exterior_ior;
  };
  std::vector<NamedMaterial> result;
  for (const Surface& surface :
       {Surface{"smooth", 0, Microfacet::single}, Surface{"rough", roughness, Microfacet::single},
        Surface{"multiple", roughness, Microfacet::multiple}})
    for (const Passing& passing :
         {Passing{"straight", Transmission::straight, 1}, Passing{"refract", Transmission::refract, 1},
          Passing{"under liquid", Transmission::refract, 1.4}}) {
      Material m;
      m.transmission = passing.transmission;
      m.exterior_ior = passing.exterior_ior;
      m.base_ior = 1.25;
      m.absorption_per_nm = optical_depth / m.pigment_thickness_nm;
      m.albedo = albedo;
      m.roughness = surface.roughness;
      m.microfacet = surface.microfacet;
      result.push_back({std::string(surface.name) + " " + passing.name, m});
    }
  return result;
}

}  // namespace sunbeam::test
