#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "bake/cli/json_text.h"
#include "bake/cli/separate_files.h"
#include "bake/live/estimator.h"
#include "bake/recipe/recipe.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/text.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_text(const std::string& text) {
  double value = 0;
  return parse_number(text, value) ? Json(value) : Json(text);
}

// Of the values: a factored table's parameters are no axes of its arrays.
const std::vector<Axis>& axes_of(const Table& table) {
  return table.is_factored() ? table.factors.grid : table.remainder.axes();
}

Json describe(const std::vector<Axis>& axes) {
  Json json = Json::array();
  for (const Axis& axis : axes)
    json.push_back({{"name", axis.name}, {"unit", axis.unit}, {"nodes", axis.nodes}});
  return json;
}

const char* name_of(Precision precision) { return precision == Precision::half_float ? "half" : "float"; }

constexpr double kReferenceNm = 510;

// A film of layers and its base, with indices at the wavelength of this number.
void describe_layers(const Material& material, const Wavelengths& waves, std::size_t k, Json& json) {
  const FilmStack stack = film_stack(material, waves, k);
  json["film"] = {{"thickness_nm", material.film_thickness_nm},
                  {"thickness_spread", material.thickness_spread},
                  {"periods", stack.periods},
                  {"wavelength_nm", waves.nm[k]}};
  for (const FilmLayer& layer : stack.layers)
    json["film"]["layers"].push_back({{"thickness_nm", layer.thickness_nm},
                                      {"ior", layer.index.real()},
                                      {"extinction", layer.index.imag()}});
  json["base"] = {{"ior", stack.base_index.real()},
                  {"extinction", stack.base_index.imag()},
                  {"opaque", material.is_opaque()}};
}

// The film that a factored table holds, at the wavelength next to that of a recipe.
void describe_layers(const Table& table, Json& json) {
  const Wavelengths& waves = table.factors.wavelengths;
  if (!table.is_factored() || !is_layered(table.material, waves)) return;
  const auto at =
      std::ranges::min_element(waves.nm, {}, [](double nm) { return std::abs(nm - kReferenceNm); });
  describe_layers(table.material, waves, static_cast<std::size_t>(at - waves.nm.begin()), json);
}

void print_layers(const Json& json) {
  const Json &film = json["film"], &base = json["base"];
  const double nm = film["wavelength_nm"].get<double>();
  out("film            {:g} nm, thickness_spread {:g}, periods {} of {} layers\n",
      film["thickness_nm"].get<double>(), film["thickness_spread"].get<double>(), film["periods"].get<int>(),
      film["layers"].size());
  for (const Json& layer : film["layers"])
    out("layer           {:g} nm, n {:g}, k {:g} at {:g} nm\n", layer["thickness_nm"].get<double>(),
        layer["ior"].get<double>(), layer["extinction"].get<double>(), nm);
  out("base            n {:g}, k {:g} at {:g} nm, {}\n", base["ior"].get<double>(),
      base["extinction"].get<double>(), nm, base["opaque"].get<bool>() ? "opaque" : "clear");
}

Json describe(const Table& table, const std::string& path) {
  Json json;
  json["schema_version"] = table.schema_version;
  json["encoding"] = table.info.at("encoding");
  std::error_code no_file;  // but a FIFO
  if (const auto bytes = std::filesystem::file_size(path, no_file); !no_file) json["bytes"] = bytes;
  json["axes"] = describe(axes_of(table));
  for (const NdArray* array : table.arrays())
    json["arrays"].push_back({{"name", array->name()},
                              {"precision", name_of(array->precision())},
                              {"axes", describe(array->axes())}});
  for (const char* key : {"recipe", "recipe_hash"}) json[key] = table.info.at(key);
  for (const char* key : {"seed", "samples"}) {
    std::uint64_t number = 0;
    parse_whole_number(table.info.at(key), number);  // the reader of tables has checked it
    json[key] = number;
  }
  for (const char* key : {"estimator", "spectrum"}) json[key] = table.info.at(key);
  json["color_space"] = to_string(table.color_space());
  if (table.is_full_spectrum()) {
    json["illuminant"] = table.info.at("illuminant");
    for (const auto& nm : split(table.info.at("wavelengths"), ' '))
      json["wavelengths"].push_back(number_or_text(nm));
  }
  json["tool_version"] = table.info.at("tool_version");
  describe_layers(table, json);
  json["error"] = Json::object();
  for (const auto& [key, value] : table.info)
    if (key.starts_with("error.")) json["error"][key.substr(6)] = number_or_text(value);
  return json;
}

void print_text(const Json& json, const Table& table) {
  for (const auto& [key, value] : json.items()) {
    if (key == "film") print_layers(json);
    if (value.is_structured() && key != "wavelengths") continue;
    if (key == "recipe") continue;
    out("{:<16}{}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  }
  for (const Axis& axis : axes_of(table))
    out("axis            {:<18} {:>4} nodes, {:g} to {:g} {}\n", axis.name, axis.size(), axis.nodes.front(),
        axis.nodes.back(), axis.unit == "1" ? "" : axis.unit);
  for (const NdArray* array : table.arrays()) {
    out("array           {:<18} {}:", array->name(), name_of(array->precision()));
    for (const Axis& axis : array->axes()) out(" {} {}", axis.name, axis.size());
    out("\n");
  }
  for (const auto& [key, value] : json["error"].items())
    out("error           {:<18} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  out("recipe\n{}\n", json["recipe"].get<std::string>());
}

Json describe(const EstimatorChoice& choice) {
  return {{"estimator", name_of(choice.estimator)}, {"reason", choice.reason}};
}

Json describe(const Recipe& recipe) {
  Json json;
  json["recipe_hash"] = recipe.hash;
  for (const auto& [key, value] : recipe.spectrum.attributes()) json[key] = value;
  const Material& material = recipe.material;
  if (is_layered(recipe))
    describe_layers(material, recipe.spectrum.monochromatic(material, kReferenceNm), 0, json);
  json["eval"] = describe(automatic_for_eval(recipe.material));
  json["render"] = describe(automatic_for_render(recipe.material));
  return json;
}

void print_text(const Json& json) {
  for (const auto& [key, value] : json.items()) {
    if (key == "film") print_layers(json);
    if (value.is_string()) out("{:<16}{}\n", key, value.get<std::string>());
    if (value.contains("reason"))
      out("{:<16}{}: {}\n", key, value["estimator"].get<std::string>(), value["reason"].get<std::string>());
  }
}

// The film of a recipe, and what `auto` takes.
int run_info_of_recipe(const InfoOptions& options) {
  const Json json = describe(load_recipe(options.source));
  if (options.json)
    out("{}\n", json_text(json));
  else
    print_text(json);
  return 0;
}

}  // namespace

int run_info(const InfoOptions& options) {
  require_separate({options.source}, {});
  if (extension(options.source) == ".toml") return run_info_of_recipe(options);
  const Table table = load_table(options.source);
  const Json json = describe(table, options.source);
  if (options.json)
    out("{}\n", json_text(json));
  else
    print_text(json, table);
  return 0;
}

}  // namespace sunbeam
