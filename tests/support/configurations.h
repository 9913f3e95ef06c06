// Every way to run the live model: film surface, transmission and absorption path, each in both spectra.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bake/optics/spectrum.h"
#include "tests/support/materials.h"

namespace sunbeam::test {

struct Configuration {
  std::string name;
  Material material;
  Wavelengths wavelengths;
};

// rgb3, and full: 16 wavelengths folded into ACEScg, of which LiveBsdf draws four in every call.
inline std::vector<std::pair<std::string, Spectrum>> both_spectra() {
  return {{"rgb3", Spectrum()}, {"full", Spectrum(Illuminant::d65, ColorSpace::acescg, 2000)}};
}

inline std::vector<Configuration> in_both_spectra(const std::vector<NamedMaterial>& materials) {
  std::vector<Configuration> result;
  for (const auto& [name, material] : materials)
    for (const auto& [colour, spectrum] : both_spectra())
      result.push_back({name + " " + colour, material, spectrum.wavelengths(material)});
  return result;
}

inline std::vector<Configuration> all_configurations() { return in_both_spectra(all_modes()); }
inline std::vector<Configuration> general_configurations() { return in_both_spectra(general_modes()); }

// Plain and general.
inline std::vector<Configuration> every_configuration() {
  auto result = all_configurations();
  for (auto& configuration : general_configurations()) result.push_back(std::move(configuration));
  return result;
}
inline std::vector<NamedMaterial> every_mode() {
  auto result = all_modes();
  for (auto& mode : general_modes()) result.push_back(std::move(mode));
  return result;
}

}  // namespace sunbeam::test
