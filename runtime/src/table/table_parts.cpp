#include "runtime/src/table/table_parts.h"

#include <algorithm>
#include <utility>

#include "runtime/src/table/table_checks.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/factor_frame.h"
#include "sunbeam/detail/hash.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/table_ranges.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::array<const char*, 3> kFilmAxes = {"film_thickness_nm", "base_ior", "cos_theta"};
constexpr std::array<const char*, 1> kFirstVisitAxes = {"optical_path"};
constexpr std::array<const char*, 7> kRestAxes = {
    "film_thickness_nm", "base_ior", "absorption_per_nm", "cos_theta_i", "phi_i", "cos_theta_o", "phi_o"};
constexpr std::array<const char*, 5> kArrivalAxes = {"base_ior", "optical_depth", "fringe_order", "cos_theta",
                                                     "phi"};
constexpr std::array<const char*, 3> kReturnedAxes = {"base_ior", "optical_depth", "fringe_order"};
constexpr std::array<const char*, 8> kExchangeAxes = {
    "base_ior", "optical_depth", "albedo", "fringe_order", "cos_theta_i", "phi_i", "cos_theta_o", "phi_o"};
// Of a grid that reaches below the exterior (sunbeam/detail/factor_frame.h).
constexpr std::array<const char*, 5> kWarpedArrivalAxes = {"base_ior", "optical_depth", "fringe_order",
                                                           "warped_cos", "phi"};
constexpr std::array<const char*, 8> kWarpedExchangeAxes = {
    "base_ior", "optical_depth", "albedo", "fringe_order", "warped_cos_i", "phi_i", "warped_cos_o", "phi_o"};
// Of layered films.
constexpr std::array<const char*, 3> kFacetCosineAxes = {"theta", "phi", "facet_rank"};
constexpr std::array<const char*, 5> kCrossingAxes = {"base_ior", "optical_depth", "theta", "phi",
                                                      "facet_rank"};
constexpr std::array<const char*, 1> kReturnCosineAxes = {"facet_rank"};
constexpr std::array<const char*, 2> kReturningAxes = {"optical_depth", "facet_rank"};
constexpr std::array<const char*, 9> kLayeredExchangeAxes = {"base_ior",      "optical_depth", "albedo",
                                                             "wavelength_nm", "fringe_order",  "cos_theta_i",
                                                             "phi_i",         "cos_theta_o",   "phi_o"};
constexpr std::array<const char*, 9> kWarpedLayeredExchangeAxes = {
    "base_ior",     "optical_depth", "albedo",       "wavelength_nm", "fringe_order",
    "warped_cos_i", "phi_i",         "warped_cos_o", "phi_o"};
constexpr std::array<const char*, 8> kRequiredInfo = {"recipe",    "recipe_hash", "seed",         "samples",
                                                      "estimator", "spectrum",    "tool_version", "encoding"};

// Hash over everything a file holds, so that damage shows.
std::string content_hash_of(const Attributes& attributes, const std::vector<ArrayView>& arrays) {
  std::string digest;
  for (const auto& [key, value] : attributes)
    if (key != "content_hash") digest += key + "=" + value + "\n";
  for (const ArrayView& array : arrays) {
    const ArrayShape& shape = array.shape();
    if (shape.channels() == 1) digest += "numbers ";
    digest += shape.name() + (shape.precision() == Precision::half_float ? " half\n" : " float\n");
    for (const auto& [key, value] : describe_axes(shape.axes())) digest += key + "=" + value + "\n";
    ContentHash hash;
    array.visit([&](std::span<const float> values) {
      hash.add({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
    });
    digest += hash.text() + "\n";
  }
  return content_hash(digest);
}

constexpr const char* kGridPrefix = "grid.";

std::vector<Axis> read_grid(const Attributes& attributes) {
  Attributes described;
  for (const auto& [key, value] : attributes)
    if (key.starts_with(kGridPrefix)) described[key.substr(std::string_view(kGridPrefix).size())] = value;
  const std::vector<Axis> grid = parse_axes(described, "grid");
  if (grid.size() != kParameterNames.size()) throw Error("attributes 'grid.*' do not describe 3 axes");
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const Axis& axis = grid[k];
    if (axis.name != kParameterNames[k])
      throw Error("grid axis " + std::to_string(k) + " is '" + axis.name + "'; expected '" +
                  kParameterNames[k] + "'");
    if (const std::string defect = axis.defect(); !defect.empty())
      throw Error("grid axis '" + axis.name + "' " + defect);
  }
  return grid;
}

void read_single_film(TableParts& parts, const Table& table, bool is_warped, Factors& factors) {
  if (!table.material.is_smooth()) {
    factors.arrival = checked_array(parts, "arrival", is_warped ? kWarpedArrivalAxes : kArrivalAxes, 1);
    check_factor_axes(table, factors.arrival, 3);
  }
  if (table.material.absorption_path == AbsorptionPath::sum) {
    factors.returned = checked_array(parts, "returned", kReturnedAxes, 1);
    check_factor_axes(table, factors.returned, kReturnedAxes.size());
  } else {
    factors.exchange = checked_array(parts, "exchange", is_warped ? kWarpedExchangeAxes : kExchangeAxes, 1);
    check_factor_axes(table, factors.exchange, 4);
    check_same_ends(factors.exchange, 4);
  }
}

// Nothing passes into an opaque base, and nothing comes back.
void read_layered_film(TableParts& parts, const Table& table, bool is_warped, Factors& factors) {
  const Material& material = table.material;
  if (!material.is_smooth() && !material.is_opaque()) {
    factors.facet_cosine = checked_array(parts, "facet_cosine", kFacetCosineAxes, 1);
    factors.crossing = checked_array(parts, "crossing", kCrossingAxes, 1);
    check_crossing_axes(table, factors.facet_cosine, factors.crossing);
  }
  if (material.absorption_path == AbsorptionPath::sum || material.is_opaque()) {
    factors.return_cosine = checked_array(parts, "return_cosine", kReturnCosineAxes, 1);
    factors.returning = checked_array(parts, "returning", kReturningAxes, 1);
    check_returning_axes(table, factors.return_cosine, factors.returning);
  } else {
    factors.exchange =
        checked_array(parts, "exchange", is_warped ? kWarpedLayeredExchangeAxes : kLayeredExchangeAxes, 1);
    check_factor_axes(table, factors.exchange, 5);
    check_same_ends(factors.exchange, 5);
  }
}

Factors read_factors(TableParts& parts, const Table& table) {
  Factors factors;
  factors.grid = read_grid(parts.attributes);
  factors.wavelengths = parse_wavelengths(parts.attributes);
  const bool needs_layers = table.schema_version > kSingleFilmSchemaVersion;
  if (needs_layers) parse_film(parts.attributes, factors.wavelengths);
  if (needs_layers && !is_layered(table.material, factors.wavelengths))
    throw Error("schema version is " + std::to_string(table.schema_version) +
                ", but the film is one clear layer on a clear base of constant indices; expected " +
                std::to_string(kSingleFilmSchemaVersion));
  const bool is_warped =
      FactorFrame(table.material, reaches_below_exterior(table.material, factors.grid[1].low())).is_warped();
  (needs_layers ? read_layered_film : read_single_film)(parts, table, is_warped, factors);
  return factors;
}

FrameKind read_frame(const Attributes& attributes) {
  const std::string& name = require(attributes, "rest_frame");
  for (const auto frame : {FrameKind::closed, FrameKind::none})
    if (name == name_of(frame)) return frame;
  throw Error("attribute 'rest_frame' is '" + shortened(name) + "'; allowed: closed, none");
}

void read_dense(TableParts& parts, Table& table) {
  table.frame = read_frame(parts.attributes);
  table.film_reflectance = checked_array(parts, "film_reflectance", kFilmAxes);
  const bool needs_layers = table.schema_version > kSingleFilmSchemaVersion;
  if (needs_layers && table.frame != FrameKind::closed)
    throw Error("attribute 'rest_frame' is '" + std::string(name_of(table.frame)) +
                "'; allowed in schema version " + std::to_string(table.schema_version) + ": closed");
  if ((!table.material.is_smooth() || needs_layers) && table.frame == FrameKind::closed)
    table.film_transmittance = checked_array(parts, "film_transmittance", kFilmAxes);
  table.remainder = checked_array(parts, "remainder", kRestAxes);
  table.rest_stderr = checked_array(parts, "rest_stderr", kRestAxes, 1);
}

// What the colours are. `spectrum` is part of the info already.
void read_spectrum(TableParts& parts, Table& table) {
  const Attributes& attributes = parts.attributes;
  const std::string& spectrum = require(attributes, "spectrum");
  if (spectrum != "rgb3" && spectrum != "full")
    throw Error("attribute 'spectrum' is '" + shortened(spectrum) + "'; allowed: rgb3, full");
  if (spectrum == "rgb3") return;
  for (const char* key : {"color_space", "illuminant", "wavelengths"})
    table.info[key] = require(attributes, key);
  if (!table.is_factored() && table.frame == FrameKind::closed) {
    table.first_visit = checked_array(parts, "first_visit", kFirstVisitAxes);
    check_first_visit_axis(table.first_visit);
  }
  try {
    table.color_space();
  } catch (const Error& error) {
    throw Error(std::string("attribute 'color_space': ") + error.what());
  }
}

// Version 2 differs in tables with a base below the exterior alone, and those were wrong.
int read_schema_version(const TableParts& parts) {
  const std::string& text = require(parts.attributes, "schema_version");
  for (int version = kOldestTableSchemaVersion; version <= kTableSchemaVersion; ++version)
    if (text == std::to_string(version)) return version;
  throw Error("schema version is '" + shortened(text) + "'; this reader knows " +
              std::to_string(kOldestTableSchemaVersion) + " to " + std::to_string(kTableSchemaVersion));
}

void check_below_exterior(const Table& table, int version) {
  if (!reaches_below(table)) return;
  const Axis& base_ior = table.parameter_axis(1);
  const std::string found = "base_ior reaches down to " + to_text(base_ior.low()) + ", below exterior_ior " +
                            to_text(table.material.exterior_ior);
  if (version < 3) throw Error(found + ": schema version 2 is wrong there; bake the table anew");
  if (!table.is_factored() && base_ior.size() > 1)
    throw Error(found + ": a dense table has one base_ior there; found " + std::to_string(base_ior.size()));
}

void check_texts(const Attributes& attributes) {
  for (const auto& [key, value] : attributes)
    if (!is_plain_text(key) || !is_plain_text(value))
      throw Error("attribute '" + printable(key) + "' is not UTF-8, or holds a control character");
  for (const char* key : {"seed", "samples"}) {
    std::uint64_t number = 0;
    if (const std::string& text = require(attributes, key); !parse_whole_number(text, number))
      throw Error("attribute '" + std::string(key) + "' is '" + shortened(text) +
                  "'; allowed: a whole number");
  }
  if (attributes.count("noise")) {
    const std::vector<double> noise = parse_numbers(attributes, "noise");
    if (noise.size() != 1) throw Error("attribute 'noise' is a list; allowed: one number");
    require_in("noise", noise, {0, 1e6});
  }
}

Material read_material(const Attributes& attributes, int schema_version) {
  Material material;
  for (const auto& key : material_keys()) {
    const std::string attribute = "material." + key;
    if (is_in_tables(key, schema_version))
      set_from_text(material, key, require(attributes, attribute));
    else if (attributes.contains(attribute))
      throw Error("attribute '" + attribute + "' is there; allowed in schema version " +
                  std::to_string(schema_version) + ": none of this name");
  }
  if (const auto defect = material.defect()) throw Error(defect->message());
  return material;
}

// The arrays of `parts` go into the table, hence the hash before.
Table build(TableParts& parts) {
  const int version = read_schema_version(parts);
  const std::string hash = content_hash_of(parts.attributes, {parts.arrays.begin(), parts.arrays.end()});
  Table table;
  table.schema_version = version;
  table.material = read_material(parts.attributes, version);
  const std::string& symmetry = require(parts.attributes, "symmetry");
  if (symmetry != "isotropic" && symmetry != "anisotropic")
    throw Error("symmetry is '" + shortened(symmetry) + "'; allowed: isotropic, anisotropic");
  table.symmetry = symmetry == "isotropic" ? Symmetry::isotropic : Symmetry::anisotropic;
  check_symmetry(table);
  const std::string& encoding = require(parts.attributes, "encoding");
  if (encoding == "factored")
    table.factors = read_factors(parts, table);
  else if (encoding == "dense")
    read_dense(parts, table);
  else
    throw Error("encoding is '" + shortened(encoding) + "'; allowed: dense, factored");
  refuse_stray_film(parts.attributes, table.factors.wavelengths);
  check_ranges(table);
  check_below_exterior(table, version);
  if (!is_hash_of_content(require(parts.attributes, "content_hash"), hash))
    throw Error("content does not match its hash: the file is damaged");
  check_texts(parts.attributes);
  for (const char* key : kRequiredInfo) table.info[key] = require(parts.attributes, key);
  read_spectrum(parts, table);
  require_in_ranges(table);
  for (const auto& [key, value] : parts.attributes)
    if (key.starts_with("error.") || key == "noise" || key == "plan") table.info[key] = value;
  return table;
}

Attributes describe_material(const Material& material, int schema_version) {
  Attributes attributes;
  for (const auto& key : material_keys()) {
    const std::string text = get_text(material, key), by_default = get_text(Material(), key);
    if (is_in_tables(key, schema_version))
      attributes[key] = text;
    else if (text != by_default)
      throw Error("key '" + key + "': found " + text + "; allowed in a table: " + by_default);
  }
  return attributes;
}

}  // namespace

Attributes attributes_of(const TableView& view) {
  const Table& table = view.head();
  const std::vector<ArrayView> arrays = view.arrays();
  const bool lacks_nodes = view.is_in_memory() && (table.remainder.empty() || table.rest_stderr.empty());
  if (!table.is_factored() && (table.film_reflectance.empty() || lacks_nodes))
    throw Error("an empty table cannot be written");
  for (const ArrayView& array : arrays) require_finite(array);
  const int version = std::max(table.schema_version, kSingleFilmSchemaVersion);
  Attributes attributes = table.info;
  attributes["schema_version"] = std::to_string(version);
  attributes["symmetry"] = name_of(table.symmetry);
  for (const auto& [key, value] : describe_material(table.material, version))
    attributes["material." + key] = value;
  if (table.is_factored()) {
    for (const auto& [key, value] : describe_axes(table.factors.grid)) attributes[kGridPrefix + key] = value;
    attributes.merge(describe_wavelengths(table.factors.wavelengths));
    Attributes film = describe_film(table.factors.wavelengths);
    if (version <= kSingleFilmSchemaVersion && !film.empty())
      throw Error("a film of layers or a dispersive base cannot be written in schema version " +
                  std::to_string(version));
    attributes.merge(film);
  } else {
    attributes["rest_frame"] = name_of(table.frame);
  }
  attributes["content_hash"] = content_hash_of(attributes, arrays);
  return attributes;
}

Table from_parts(TableParts parts, const std::string& name) {
  try {
    std::sort(parts.arrays.begin(), parts.arrays.end(),
              [](const auto& a, const auto& b) { return a.name() < b.name(); });
    return build(parts);
  } catch (const Error& error) {
    throw Error(name + ": not a usable table: " + error.what());
  }
}

}  // namespace v1
}  // namespace sunbeam
