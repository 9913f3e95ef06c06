#include "sunbeam/material.h"

#include <array>
#include <cstddef>
#include <tuple>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

struct NumericKey {
  std::string_view name;
  double Material::*member;
  Interval allowed;
};

constexpr Interval kOpaqueBaseIor{0.05, 10};

constexpr std::array<NumericKey, 10> kNumericKeys{{
    {"film_thickness_nm", &Material::film_thickness_nm, {0, 1e5}},
    {"exterior_ior", &Material::exterior_ior, {1, 5}},
    {"film_ior", &Material::film_ior, {1, 5}},
    {"base_ior", &Material::base_ior, {1, 5}},
    {"base_extinction", &Material::base_extinction, {0, 100}},
    {"thickness_spread", &Material::thickness_spread, {0, 0.3}},
    {"absorption_per_nm", &Material::absorption_per_nm, {0, 1000}},
    {"pigment_thickness_nm", &Material::pigment_thickness_nm, {0, 1e6}},
    {"scattering_per_nm", &Material::scattering_per_nm, {0, 1000}},
    {"anisotropy", &Material::anisotropy, {-0.99, 0.99}},
}};

const NumericKey* find_numeric(std::string_view key) {
  for (const auto& entry : kNumericKeys)
    if (entry.name == key) return &entry;
  return nullptr;
}

[[noreturn]] void refuse(std::string_view key, const std::string& found, const std::string& allowed) {
  throw Error("key '" + std::string(key) + "': found '" + shortened(found) + "'; allowed: " + allowed);
}

// One value, or `count` values separated by ';'. All inside the interval.
std::vector<double> parse_list(std::string_view key, const std::string& text, std::size_t count,
                               const Interval& allowed) {
  const std::string range = to_text(allowed.low) + " to " + to_text(allowed.high);
  std::vector<double> values;
  for (const auto& part : split(text, ';')) {
    double value = 0;
    if (!parse_number(part, value) || !(value >= allowed.low && value <= allowed.high))
      refuse(key, text, range);
    values.push_back(value);
  }
  if (values.size() != 1 && values.size() != count)
    refuse(key, text, "one value" + (count > 1 ? " or " + std::to_string(count) + " separated by ';'" : ""));
  return values;
}

void set_roughness(Material& material, const std::string& text) {
  const auto values = parse_list("roughness", text, 2, allowed_interval("roughness"));
  const Roughness roughness(values.front(), values.back());
  if (!roughness.is_allowed()) refuse("roughness", text, allowed_roughness());
  material.roughness = roughness;
}

void set_albedo(Material& material, const std::string& text) {
  const auto values = parse_list("albedo", text, 3, allowed_interval("albedo"));
  material.albedo = values.size() == 1 ? Rgb(values[0]) : Rgb(values[0], values[1], values[2]);
}

}  // namespace

std::optional<Material::Defect> Material::defect() const {
  if (is_opaque()) {
    for (const auto& [key, value, depth] : {std::tuple("albedo", max_component(albedo), 1.0),
                                            {"absorption_per_nm", absorption_per_nm, pigment_thickness_nm},
                                            {"scattering_per_nm", scattering_per_nm, pigment_thickness_nm}})
      if (value * depth > 0)
        return Defect{key, "found " + to_text(value) +
                               " over an opaque base (base_extinction > 0), below which nothing "
                               "is seen; allowed: 0"};
    return {};
  }
  const Interval clear = allowed_interval("base_ior");
  if (!(base_ior >= clear.low && base_ior <= clear.high))
    return Defect{"base_ior", "found " + to_text(base_ior) + "; allowed: " + to_text(clear.low) + " to " +
                                  to_text(clear.high) + ", or more with base_extinction > 0"};
  if (!scatters()) return {};
  if (absorption_path == AbsorptionPath::product)
    return Defect{"absorption_path", "found product with scattering_per_nm > 0; allowed: sum"};
  if (scattering_depth() > kMostScatteringDepth)
    return Defect{"scattering_per_nm",
                  "found an optical thickness scattering_per_nm * pigment_thickness_nm of " +
                      to_text(scattering_depth()) + "; allowed: up to " + to_text(kMostScatteringDepth)};
  return {};
}

double Material::radiance_scale() const {
  return transmission == Transmission::refract ? square(exterior_ior / base_ior) : 1;
}

double Material::cosine_below(double cos_exterior) const {
  if (transmission == Transmission::straight) return cos_exterior;
  return std::sqrt(std::max(0.0, 1 - square(exterior_ior / base_ior) * (1 - square(cos_exterior))));
}

double Material::absorption_exponent(double cos_i, double cos_o) const {
  const double path =
      absorption_path == AbsorptionPath::product ? 1 / (cos_i * cos_o) : 1 / cos_i + 1 / cos_o;
  return -optical_depth() * path;
}

const std::vector<std::string>& material_keys() {
  static const std::vector<std::string> keys = {"transmission",
                                                "absorption_path",
                                                "film_thickness_nm",
                                                "exterior_ior",
                                                "film_ior",
                                                "thickness_spread",
                                                "base_extinction",
                                                "base_ior",
                                                "absorption_per_nm",
                                                "pigment_thickness_nm",
                                                "scattering_per_nm",
                                                "anisotropy",
                                                "albedo",
                                                "roughness",
                                                "microfacet"};
  return keys;
}

std::string_view to_string(Transmission transmission) {
  return transmission == Transmission::straight ? "straight" : "refract";
}

std::string_view to_string(AbsorptionPath path) {
  return path == AbsorptionPath::product ? "product" : "sum";
}

std::string_view to_string(Microfacet microfacet) {
  return microfacet == Microfacet::single ? "single" : "multiple";
}

std::string allowed_roughness() {
  return "0 (smooth) or " + to_text(kMinRoughness) + " to 1, or two such values for an anisotropic film";
}

std::string to_string(const Roughness& roughness) {
  if (roughness.is_isotropic()) return to_text(roughness.u);
  return to_text(roughness.u) + ";" + to_text(roughness.v);
}

Interval allowed_interval(std::string_view key) {
  if (key == "albedo" || key == "roughness") return {0, 1};
  return find_numeric(key)->allowed;
}

Interval allowed_interval(std::string_view key, const Material& material) {
  return key == "base_ior" && material.is_opaque() ? kOpaqueBaseIor : allowed_interval(key);
}

std::string get_text(const Material& material, std::string_view key) {
  if (key == "transmission") return std::string(to_string(material.transmission));
  if (key == "absorption_path") return std::string(to_string(material.absorption_path));
  if (key == "albedo")
    return to_text(material.albedo.r) + ";" + to_text(material.albedo.g) + ";" + to_text(material.albedo.b);
  if (key == "roughness") return to_string(material.roughness);
  if (key == "microfacet") return std::string(to_string(material.microfacet));
  return to_text(material.*(find_numeric(key)->member));
}

void set_from_text(Material& material, std::string_view key, const std::string& text) {
  if (key == "transmission") {
    if (text != "straight" && text != "refract") refuse(key, text, "straight, refract");
    material.transmission = text == "straight" ? Transmission::straight : Transmission::refract;
  } else if (key == "absorption_path") {
    if (text != "product" && text != "sum") refuse(key, text, "product, sum");
    material.absorption_path = text == "product" ? AbsorptionPath::product : AbsorptionPath::sum;
  } else if (key == "microfacet") {
    if (text != "single" && text != "multiple") refuse(key, text, "single, multiple");
    material.microfacet = text == "single" ? Microfacet::single : Microfacet::multiple;
  } else if (key == "albedo") {
    set_albedo(material, text);
  } else if (key == "roughness") {
    set_roughness(material, text);
  } else if (const NumericKey* numeric = find_numeric(key)) {
    material.*(numeric->member) = parse_list(key, text, 1, allowed_interval(key, material)).front();
  } else {
    throw Error("'" + std::string(key) + "' is not a material key");
  }
}

}  // namespace v1
}  // namespace sunbeam
