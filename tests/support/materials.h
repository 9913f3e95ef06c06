// Materials the random tests share.
#pragma once

#include <string>
#include <vector>

#include "bake/live/wavelengths.h"
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
