#include "runtime/src/table/table_parts.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "runtime/src/table/table_checks.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/factor_frame.h"
#include "sunbeam/detail/hash.h"
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

const std::string& require(const Attributes& attributes, std::string_view key) {
  const auto at = attributes.find(std::string(key));
  if (at == attributes.end()) throw Error("attribute '" + std::string(key) + "' is missing");
  return at->second;
}

// Calls visit(word) for what single spaces separate.
template <class Visit>
void for_each_word(std::string_view text, Visit visit) {
  for (;;) {
    const auto end = text.find(' ');
    visit(text.substr(0, end));
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

std::vector<double> parse_numbers(const Attributes& attributes, const std::string& key) {
  std::vector<double> numbers;
  for_each_word(require(attributes, key), [&](std::string_view text) {
    double value = 0;
    if (!parse_number(text, value) || !std::isfinite(value))
      throw Error("attribute '" + key + "' holds '" + shortened(text) + "', which is no finite number");
    numbers.push_back(value);
  });
  return numbers;
}

void require_in(const std::string& key, const std::vector<double>& values, const Interval& allowed) {
  for (const double value : values)
    if (!(value >= allowed.low && value <= allowed.high))
      throw Error("attribute '" + key + "' holds " + to_text(value) + "; allowed: " + to_text(allowed.low) +
                  " to " + to_text(allowed.high));
}

constexpr std::array<const char*, 3> kWeightNames = {"spectral.weight_r", "spectral.weight_g",
                                                     "spectral.weight_b"};

// A bake's weights add up to 1, so that white is white.
void require_weights(const std::string& key, const std::vector<double>& weights) {
  constexpr Interval kSum{0.5, 2};
  require_in(key, weights, {-2, 2});
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum >= kSum.low && sum <= kSum.high))
    throw Error("attribute '" + key + "' adds up to " + to_text(sum) + "; allowed: " + to_text(kSum.low) +
                " to " + to_text(kSum.high));
}

Wavelengths read_wavelengths(const Attributes& attributes) {
  Wavelengths w;
  w.nm = parse_numbers(attributes, "spectral.nm");
  w.albedo = parse_numbers(attributes, "spectral.albedo");
  w.absorption = parse_numbers(attributes, "spectral.absorption");
  const auto r = parse_numbers(attributes, kWeightNames[0]), g = parse_numbers(attributes, kWeightNames[1]),
             b = parse_numbers(attributes, kWeightNames[2]);
  const std::size_t count = w.nm.size();
  for (const std::size_t size : {w.albedo.size(), w.absorption.size(), r.size(), g.size(), b.size()})
    if (size != count || count > kMostWavelengths)
      throw Error("attributes 'spectral.*' are lists of different lengths, or of more than " +
                  std::to_string(kMostWavelengths));
  require_in("spectral.nm", w.nm, {300, 1000});
  require_in("spectral.albedo", w.albedo, {0, 1});
  for (const double absorption : w.absorption)
    if (!(absorption >= 0)) throw Error("attribute 'spectral.absorption' holds a negative number");
  require_in("spectral.absorption", w.absorption, {0, 1e12});
  const std::vector<double>* const weights[] = {&r, &g, &b};
  for (int c = 0; c < 3; ++c) require_weights(kWeightNames[c], *weights[c]);
  for (std::size_t k = 0; k < count; ++k) w.weight.push_back({r[k], g[k], b[k]});
  return w;
}

void write_wavelengths(const Wavelengths& w, Attributes& attributes) {
  attributes["spectral.nm"] = to_text(w.nm);
  attributes["spectral.albedo"] = to_text(w.albedo);
  attributes["spectral.absorption"] = to_text(w.absorption);
  for (int c = 0; c < 3; ++c) {
    std::vector<double> weights;
    for (const Rgb& weight : w.weight) weights.push_back(weight[c]);
    attributes[kWeightNames[c]] = to_text(weights);
  }
}

constexpr const char* kGridPrefix = "grid.";

Factors read_factors(TableParts& parts, const Table& table) {
  Factors factors;
  Attributes grid;
  for (const auto& [key, value] : parts.attributes)
    if (key.starts_with(kGridPrefix)) grid[key.substr(std::string_view(kGridPrefix).size())] = value;
  factors.grid = parse_axes(grid, "grid");
  if (factors.grid.size() != kParameterNames.size())
    throw Error("attributes 'grid.*' do not describe 3 axes");
  for (std::size_t k = 0; k < factors.grid.size(); ++k) {
    const Axis& axis = factors.grid[k];
    if (axis.name != kParameterNames[k])
      throw Error("grid axis " + std::to_string(k) + " is '" + axis.name + "'; expected '" +
                  kParameterNames[k] + "'");
    if (const std::string defect = axis.defect(); !defect.empty())
      throw Error("grid axis '" + axis.name + "' " + defect);
  }
  factors.wavelengths = read_wavelengths(parts.attributes);
  const bool is_warped =
      FactorFrame(table.material, reaches_below_exterior(table.material, factors.grid[1].low())).is_warped();
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
    check_same_ends(factors.exchange);
  }
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
  if (!table.material.is_smooth() && table.frame == FrameKind::closed)
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

// The arrays of `parts` go into the table, hence the hash before.
Table build(TableParts& parts) {
  const int version = read_schema_version(parts);
  const std::string hash = content_hash_of(parts.attributes, {parts.arrays.begin(), parts.arrays.end()});
  Table table;
  table.schema_version = version;
  for (const auto& key : material_keys()) {
    const std::string attribute = "material." + key;
    if (is_in_tables(key))
      set_from_text(table.material, key, require(parts.attributes, attribute));
    else if (parts.attributes.contains(attribute))
      throw Error("attribute '" + attribute + "' is there; allowed in schema versions up to " +
                  std::to_string(kTableSchemaVersion) + ": none of this name");
  }
  if (const auto defect = table.material.defect()) throw Error(defect->message());
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

}  // namespace

Attributes describe_axes(const std::vector<Axis>& axes) {
  Attributes result;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const std::string prefix = "axis." + std::to_string(k) + ".";
    result[prefix + "name"] = axes[k].name;
    result[prefix + "unit"] = axes[k].unit;
    result[prefix + "power"] = to_text(axes[k].power);
    result[prefix + "period"] = to_text(axes[k].period);
    result[prefix + "origin"] = to_text(axes[k].origin);
    if (axes[k].softness > 0) result[prefix + "softness"] = to_text(axes[k].softness);
    result[prefix + "interpolation"] = axes[k].is_cubic ? "cubic" : "linear";
    result[prefix + "nodes"] = to_text(axes[k].nodes);
  }
  return result;
}

std::vector<Axis> parse_axes(const Attributes& attributes, const std::string& array_name) {
  std::vector<Axis> axes;
  for (std::size_t k = 0; k < NdArray::kMaxRank; ++k) {
    const std::string prefix = "axis." + std::to_string(k) + ".";
    if (!attributes.count(prefix + "name")) break;
    Axis axis;
    axis.name = require(attributes, prefix + "name");
    axis.unit = require(attributes, prefix + "unit");
    constexpr std::size_t kLongest = 100;
    for (const std::string* text : {&axis.name, &axis.unit})
      if (!is_plain_text(*text) || text->size() > kLongest)
        throw Error("array '" + array_name + "': axis '" + shortened(axis.name) +
                    "' has a name or unit that is not UTF-8, holds a control character or is longer than " +
                    std::to_string(kLongest) + " bytes");
    const auto number = [&](std::string_view text) {
      double value = 0;
      if (!parse_number(text, value))
        throw Error("array '" + array_name + "': axis '" + axis.name + "' holds '" + shortened(text) +
                    "', which is no number");
      return value;
    };
    axis.power = number(require(attributes, prefix + "power"));
    axis.period = number(require(attributes, prefix + "period"));
    axis.origin = number(require(attributes, prefix + "origin"));
    if (attributes.count(prefix + "softness")) axis.softness = number(attributes.at(prefix + "softness"));
    const std::string& interpolation = require(attributes, prefix + "interpolation");
    if (interpolation != "linear" && interpolation != "cubic")
      throw Error("array '" + array_name + "': axis '" + axis.name + "' has interpolation '" +
                  shortened(interpolation) + "'; allowed: linear, cubic");
    axis.is_cubic = interpolation == "cubic";
    for_each_word(require(attributes, prefix + "nodes"),
                  [&](std::string_view node) { axis.nodes.push_back(number(node)); });
    axes.push_back(std::move(axis));
  }
  return axes;
}

Attributes attributes_of(const TableView& view) {
  const Table& table = view.head();
  const std::vector<ArrayView> arrays = view.arrays();
  const bool lacks_nodes = view.is_in_memory() && (table.remainder.empty() || table.rest_stderr.empty());
  if (!table.is_factored() && (table.film_reflectance.empty() || lacks_nodes))
    throw Error("an empty table cannot be written");
  for (const ArrayView& array : arrays) require_finite(array);
  Attributes attributes = table.info;
  attributes["schema_version"] = std::to_string(std::max(table.schema_version, kSingleFilmSchemaVersion));
  attributes["symmetry"] = name_of(table.symmetry);
  for (const auto& key : material_keys()) {
    const std::string text = get_text(table.material, key);
    if (is_in_tables(key))
      attributes["material." + key] = text;
    else if (text != get_text(Material(), key))
      throw Error("key '" + key + "': found " + text + "; allowed in a table: " + get_text(Material(), key));
  }
  if (table.is_factored()) {
    for (const auto& [key, value] : describe_axes(table.factors.grid)) attributes[kGridPrefix + key] = value;
    write_wavelengths(table.factors.wavelengths, attributes);
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
