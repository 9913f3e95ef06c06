#include "bake/recipe/material_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bake/recipe/film_keys.h"
#include "bake/recipe/range_of.h"

namespace sunbeam {
namespace {

constexpr const char* kRoughness = "roughness";

// One value, or [alpha_u, alpha_v].
Roughness read_roughness(const ConfigTable& config, const Roughness& fallback) {
  if (!config.has(kRoughness)) return fallback;
  const auto values = config.is_list(kRoughness)
                          ? config.numbers(kRoughness, range_of(kRoughness))
                          : std::vector{config.number(kRoughness, range_of(kRoughness))};
  if (values.empty() || values.size() > 2)
    config.fail(kRoughness,
                fmt::format("found {} numbers; allowed: one number or a list of 2", values.size()));
  const Roughness roughness(values.front(), values.back());
  if (!roughness.is_allowed())
    config.fail(kRoughness,
                fmt::format("found {}; allowed: {}", fmt::join(values, ", "), allowed_roughness()));
  return roughness;
}

// Pigment and diffuse base of a clear base but for the albedo.
void read_below(const ConfigTable& config, Material& m) {
  m.absorption_path = static_cast<AbsorptionPath>(config.choice("absorption_path", {"product", "sum"}, 1));
  const auto number = [&](const char* key, double& value) {
    value = config.number(key, range_of(key), value);
  };
  number("absorption_per_nm", m.absorption_per_nm);
  number("pigment_thickness_nm", m.pigment_thickness_nm);
  number("scattering_per_nm", m.scattering_per_nm);
  number("anisotropy", m.anisotropy);
}

void refuse_below(const ConfigTable& config, Material& m) {
  for (const char* key : {"albedo", "absorption_per_nm", "pigment_thickness_nm", "scattering_per_nm",
                          "anisotropy", "absorption_spectrum", "absorption_path"})
    if (config.has(key))
      config.fail(key, "found, but the base absorbs, and nothing is seen below it; leave the key out");
  m.albedo = Rgb();
  m.absorption_per_nm = 0;
}

}  // namespace

MaterialKeys read_material(const ConfigTable& config) {
  MaterialKeys keys;
  Material& m = keys.material;
  m.transmission = static_cast<Transmission>(config.choice("transmission", {"straight", "refract"}, 1));
  m.exterior_ior = config.number("exterior_ior", range_of("exterior_ior"), m.exterior_ior);
  keys.film = read_film_and_base(config, m);
  m.thickness_spread = config.number("thickness_spread", range_of("thickness_spread"), m.thickness_spread);
  m.roughness = read_roughness(config, m.roughness);
  m.microfacet = static_cast<Microfacet>(config.choice("microfacet", {"single", "multiple"}, 0));
  if (m.is_opaque())
    refuse_below(config, m);
  else
    read_below(config, m);
  if (const auto defect = m.defect()) config.fail(defect->key, defect->text);
  return keys;
}

}  // namespace sunbeam
