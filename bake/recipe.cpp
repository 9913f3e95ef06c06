#include "bake/recipe.h"

#include <fmt/format.h>

#include "runtime/config/config.h"
#include "sunbeam/core/file.h"
#include "sunbeam/core/hash.h"
#include "sunbeam/table.h"

namespace sunbeam {
namespace {

Range range_of(std::string_view key) {
  const Interval allowed = allowed_interval(key);
  return {allowed.low, allowed.high};
}

constexpr const char* kRoughness = "roughness";

// [alpha_u, alpha_v], which have to be equal.
double read_roughness_pair(const ConfigTable& config) {
  const auto values = config.numbers(kRoughness, range_of(kRoughness));
  if (values.size() != 2)
    config.fail(kRoughness,
                fmt::format("found {} numbers; allowed: one number or a list of 2", values.size()));
  if (values[0] != values[1])
    config.fail(kRoughness,
                fmt::format("found [{:g}, {:g}]; allowed: two equal values (an anisotropic film is not "
                            "supported yet)",
                            values[0], values[1]));
  return values[0];
}

double read_roughness(const ConfigTable& config, double fallback) {
  const double value = config.is_list(kRoughness) ? read_roughness_pair(config)
                                                  : config.number(kRoughness, range_of(kRoughness), fallback);
  if (value > 0 && value < kMinRoughness)
    config.fail(kRoughness,
                fmt::format("found {:g}; allowed: 0 (smooth) or {:g} to 1", value, kMinRoughness));
  return value;
}

Material read_material(const ConfigTable& config) {
  Material m;
  m.transmission = static_cast<Transmission>(config.choice("transmission", {"straight", "refract"}, 1));
  m.absorption_path = static_cast<AbsorptionPath>(config.choice("absorption_path", {"product", "sum"}, 1));
  const auto number = [&](const char* key, double& value) {
    value = config.number(key, range_of(key), value);
  };
  number("film_thickness_nm", m.film_thickness_nm);
  number("exterior_ior", m.exterior_ior);
  number("film_ior", m.film_ior);
  number("base_ior", m.base_ior);
  number("absorption_per_nm", m.absorption_per_nm);
  number("pigment_thickness_nm", m.pigment_thickness_nm);
  m.roughness = read_roughness(config, m.roughness);
  m.albedo = config.rgb("albedo", {0, 1}, m.albedo);
  return m;
}

// The axes without nodes. Their coordinates follow how the rest depends on a parameter: like the square root
// of the base IOR's distance from index match, and ever more slowly with absorption.
std::array<Axis, 3> bare_axes(const Material& material) {
  Axis thickness{kParameterNames[0], "nm", {}};
  Axis base_ior{kParameterNames[1], "1", {}, 2, 0, material.exterior_ior};
  Axis absorption{kParameterNames[2], "1/nm", {}, 3};
  return {thickness, base_ior, absorption};
}

// A base thinner than the exterior has no square root at its first node.
double power_above(const Axis& axis, double first) { return first < axis.origin ? 1 : axis.power; }

std::vector<double> read_nodes(const ConfigTable& grid, const Axis& axis) {
  const std::string& key = axis.name;
  const Range allowed = range_of(key);
  if (!grid.is_table(key)) {
    const auto nodes = grid.numbers(key, allowed);
    for (std::size_t i = 1; i < nodes.size(); ++i)
      if (nodes[i] <= nodes[i - 1])
        grid.fail(key,
                  fmt::format("found {} after {}; allowed: a list that increases", nodes[i], nodes[i - 1]));
    if (nodes.empty()) grid.fail(key, "the list is empty; allowed: at least one number");
    return nodes;
  }
  const ConfigTable range = grid.table(key);
  const double from = range.number("from", allowed);
  const double to = range.number("to", {from, allowed.high});
  const int count = range.integer("count", 1, 4096);
  if ((count == 1) != (from == to))
    range.fail(
        "count",
        fmt::format("found {} nodes from {} to {}; allowed: one node with from = to, several with from < to",
                    count, from, to));
  return spaced_nodes(from, to, static_cast<std::size_t>(count), power_above(axis, from), axis.origin);
}

std::vector<Axis> read_grid(const ConfigTable& grid, const Material& material) {
  const auto defaults = Parameters::of(material).values();
  std::vector<Axis> axes;
  for (Axis axis : bare_axes(material)) {
    axis.nodes = grid.has(axis.name) ? read_nodes(grid, axis) : std::vector{defaults[axes.size()]};
    axis.power = power_above(axis, axis.nodes.front());
    axes.push_back(std::move(axis));
  }
  return axes;
}

}  // namespace

Recipe parse_recipe(const std::string& text, const std::string& name,
                    const std::vector<std::string>& overrides) {
  const ConfigTable config = ConfigTable::parse(text, name, overrides);
  Recipe recipe;
  recipe.name = name;
  recipe.material = read_material(config.table("material"));
  recipe.grid = read_grid(config.table("grid"), recipe.material);

  const ConfigTable table = config.table("table");
  recipe.table.angles = table.integer("angles", 2, 512, recipe.table.angles);
  recipe.table.azimuths = table.integer("azimuths", 1, 512, recipe.table.azimuths);
  recipe.table.precision = static_cast<Precision>(table.choice("precision", {"half", "float"}, 0));
  table.choice("encoding", {"dense"}, 0);

  const ConfigTable accuracy = config.table("accuracy");
  recipe.accuracy.noise = accuracy.number("noise", {1e-4, 1}, recipe.accuracy.noise);
  recipe.accuracy.tolerance_median =
      accuracy.number("tolerance_median", {1e-6, 10}, recipe.accuracy.tolerance_median);
  recipe.accuracy.tolerance_p99 = accuracy.number("tolerance_p99", {1e-6, 10}, recipe.accuracy.tolerance_p99);

  config.table("spectrum").choice("mode", {"rgb3"}, 0);
  config.finish();
  recipe.text = config.canonical_text();
  recipe.hash = content_hash(recipe.text);
  return recipe;
}

Recipe load_recipe(const std::string& path, const std::vector<std::string>& overrides) {
  return parse_recipe(read_file(path), path, overrides);
}

}  // namespace sunbeam
