// Materials the random tests share.
#pragma once

#include <string>
#include <vector>

#include "sunbeam/detail/wavelengths.h"
#include "sunbeam/material.h"

namespace sunbeam::test {

struct NamedMaterial {
  std::string name;
  Material material;
};

// Every combination of film surface, transmission and absorption path, of bright skin: little is absorbed, so
// that several visits of the base count.
inline std::vector<NamedMaterial> all_modes(double roughness = 0.3, double optical_depth = 0.1,
                                            const Rgb& albedo = {0.9, 0.8, 0.6}) {
  std::vector<NamedMaterial> result;
  for (const double alpha : {0.0, roughness})
    for (const auto transmission : {Transmission::straight, Transmission::refract})
      for (const auto path : {AbsorptionPath::product, AbsorptionPath::sum}) {
        Material m;
        m.transmission = transmission;
        m.absorption_path = path;
        m.film_thickness_nm = 350;
        m.base_ior = 1.4;
        m.absorption_per_nm = optical_depth / m.pigment_thickness_nm;
        m.albedo = albedo;
        m.roughness = alpha;
        result.push_back({std::string(alpha > 0 ? "rough " : "smooth ") +
                              std::string(to_string(transmission)) + " " + std::string(to_string(path)),
                          m});
      }
  return result;
}

// One of each kind that is not plain (Material::is_plain): scattering pigments, anisotropic films, facets met
// many times, together and apart, with and without bending; bright, so that walks are long.
inline std::vector<NamedMaterial> general_modes() {
  Material bright;
  bright.film_thickness_nm = 350;
  bright.base_ior = 1.4;
  bright.absorption_per_nm = 0.05;
  bright.albedo = {0.9, 0.8, 0.6};
  const auto scattering = [](Material m, double optical_thickness, double g) {
    m.scattering_per_nm = optical_thickness / m.pigment_thickness_nm;
    m.anisotropy = g;
    return m;
  };
  const auto film = [&](const Roughness& roughness, Microfacet microfacet, Transmission transmission) {
    Material m = bright;
    m.roughness = roughness;
    m.microfacet = microfacet;
    m.transmission = transmission;
    return m;
  };
  const auto single = Microfacet::single, multiple = Microfacet::multiple;
  const auto refract = Transmission::refract, straight = Transmission::straight;

  std::vector<NamedMaterial> modes = {
      {"smooth slab", scattering(film(0, single, refract), 1, 0.5)},
      {"rough slab", scattering(film(0.3, single, refract), 2, 0.8)},
      {"straight slab", scattering(film(0.3, single, straight), 0.5, -0.3)},
      {"anisotropic", film({0.1, 0.4}, single, refract)},
      {"anisotropic product", film({0.4, 0.15}, single, straight)},
      {"multiple", film(0.3, multiple, refract)},
      {"multiple very rough", film(0.9, multiple, refract)},
      {"multiple straight product", film(0.5, multiple, straight)},
      {"multiple index-matched", film(0.4, multiple, refract)},
      {"multiple nearly index-matched", film(0.4, multiple, refract)},
      {"all", scattering(film({0.2, 0.5}, multiple, refract), 1, 0.9)},
  };
  for (auto& [name, m] : modes) {
    if (name.ends_with("product")) m.absorption_path = AbsorptionPath::product;
    if (name.ends_with("index-matched")) m.base_ior = name.find("nearly") == std::string::npos ? 1 : 1.01;
  }
  return modes;
}

// A coat of index 1.5 without a film over a diffuse base, as other renderers have it.
inline Material coated_diffuse(double roughness) {
  Material m;
  m.film_thickness_nm = 0;
  m.film_ior = m.base_ior = 1.5;
  m.absorption_per_nm = 0.01;
  m.pigment_thickness_nm = 1;
  m.albedo = Rgb(0.5);
  m.roughness = roughness;
  return m;
}

// Unevenly weighted, with an albedo and an absorption of their own at each; channels stay positive.
inline Wavelengths twelve_wavelengths(const Material& material) {
  Wavelengths w;
  for (int k = 0; k < 12; ++k) {
    w.nm.push_back(400 + 27.0 * k);
    w.albedo.push_back(material.albedo[k % 3] * (1 - 0.02 * k));
    w.absorption.push_back(2.0 - 0.15 * k);
    w.weight.push_back(Rgb(k < 8 ? 0.125 : 0, k < 6 ? 0.15 : 0.1 / 6, k < 2 ? -0.05 : 0.11));
  }
  return w;
}

}  // namespace sunbeam::test
