#include "bake/check/point_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "runtime/config/config.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

// Returns the letters and digits of a name, in lower case and without a unit behind them: "Film thickness
// (um)" and "film_thickness_nm" are the same then.
std::string core_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    const bool is_upper = c >= 'A' && c <= 'Z';
    if (is_upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      words.back() += is_upper ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  constexpr std::array kUnits = {"per",      "nm",         "um",      "mm",         "cm",  "m",
                                 "angstrom", "nanometres", "deg",     "degree",     "rad", "degrees",
                                 "radians",  "micron",     "microns", "nanometers", ""};
  while (words.size() > 1 && std::find(kUnits.begin(), kUnits.end(), words.back()) != kUnits.end())
    words.pop_back();
  return fmt::format("{}", fmt::join(words, ""));
}

struct Key {
  std::string name, core;
};

// Keys of recipes that no row can replace.
constexpr std::array kRecipeKeys = {"film_periods", "film_extinction"};

void refuse_recipe_keys(const Csv& csv) {
  for (const char* key : kRecipeKeys)
    if (csv.column(key))
      throw Error(fmt::format("{}: column '{}': a key of recipes alone; allowed: another recipe, or --set",
                              csv.name, key));
}

std::vector<Key> known_keys() {
  std::vector<std::string> names = {"theta_i_deg", "theta_o_deg",   "phi_deg",
                                    "phi_i_deg",   "wavelength_nm", "layers"};
  names.insert(names.end(), material_keys().begin(), material_keys().end());
  names.insert(names.end(), kRecipeKeys.begin(), kRecipeKeys.end());
  std::vector<Key> keys;
  for (const auto& name : names) keys.push_back({name, core_of(name)});
  return keys;
}

// Returns how many letters must change, or any number above `limit` if they are more.
std::size_t distance(const std::string& a, const std::string& b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > limit) return limit + 1;
  return edit_distance(a, b);
}

// Returns the share of a key's letters that a name has wrong, or any number above a quarter. A name that is
// the last words of a key has none wrong.
double misspelling(const std::string& name, const std::string& core, const Key& key) {
  constexpr std::size_t kTelling = 6;
  if (core.size() >= kTelling && key.core.ends_with(core)) return 0;
  const std::size_t limit = key.core.size() / 4;
  const std::size_t wrong = std::min(distance(core, key.core, limit), distance(name, key.name, limit));
  return static_cast<double>(wrong) / static_cast<double>(key.core.size());
}

void refuse_if_almost_known(const Csv& csv, const std::string& name, const std::vector<Key>& keys) {
  const std::string core = core_of(name);
  const auto share = [&](const Key& key) { return misspelling(name, core, key); };
  const Key& likely = *std::ranges::min_element(keys, {}, share);
  if (share(likely) <= 0.25)
    throw Error(fmt::format("{}: column '{}' is almost '{}'; allowed: that name, or one unlike every key",
                            csv.name, name, likely.name));
}

}  // namespace

std::vector<std::string> result_names(Quantity quantity, bool monochromatic) {
  const auto expand = [&](std::initializer_list<const char*> names) {
    std::vector<std::string> columns;
    for (const std::string name : names) {
      if (monochromatic || name == "pdf")
        columns.push_back(name);
      else
        for (const char* suffix : {"_r", "_g", "_b"}) columns.push_back(name + suffix);
    }
    return columns;
  };
  if (quantity == Quantity::brdf) return expand({"first", "rest", "stderr", "pdf", "dirac"});
  if (quantity == Quantity::albedo) return expand({"total", "stderr"});
  return expand({"reflectance"});
}

PointColumns::PointColumns(const Csv& csv, Quantity quantity)
    : csv_(csv), phi_i_(csv.column("phi_i_deg")), wavelength_(csv.column("wavelength_nm")) {
  refuse_recipe_keys(csv);
  const std::vector<Key> keys = known_keys();
  for (const auto& name : result_names(quantity, is_monochromatic()))
    if (csv.column(name))
      throw Error(fmt::format("{}: column '{}' has the name of an output column", csv.name, name));
  for (std::size_t k = 0; k < csv.header.size(); ++k) {
    const std::string& name = csv.header[k];
    if (std::ranges::count(material_keys(), name) > 0) material_columns_.push_back(k);
    if (std::ranges::count(keys, name, &Key::name) > 0) continue;
    refuse_if_almost_known(csv, name, keys);
    if (!name.empty()) unused_.push_back(name);
  }
  const auto order = [&](std::size_t k) { return std::ranges::find(material_keys(), csv.header[k]); };
  std::ranges::sort(material_columns_, {}, order);
  theta_i_ = require("theta_i_deg");
  if (quantity == Quantity::brdf) {
    theta_o_ = require("theta_o_deg");
    phi_ = require("phi_deg");
  }
}

Point PointColumns::point(std::size_t row_index) const {
  const CsvRow& row = csv_.rows[row_index];
  const double phi_i = phi_i_ ? azimuth_deg(row, *phi_i_) : 0;
  Point point{polar(row, theta_i_, phi_i), {0, 0, 1}, {}, row_index};
  if (theta_o_) point.wo = polar(row, *theta_o_, phi_i + azimuth_deg(row, *phi_));
  if (wavelength_) point.wavelength_nm = csv_.number(row, *wavelength_, 100, 10000, true);
  return point;
}

Material PointColumns::material(std::size_t row_index, Material material) const {
  const CsvRow& row = csv_.rows[row_index];
  try {
    for (const std::size_t k : material_columns_)
      set_from_text(material, csv_.header[k], std::string(trimmed(row.cells[k])));
    if (const auto defect = material.defect()) throw Error(defect->message());
  } catch (const Error& error) {
    throw Error(fmt::format("{}:{}: {}", csv_.name, row.line, error.what()));
  }
  return material;
}

std::size_t PointColumns::require(const std::string& key) const {
  const auto column = csv_.column(key);
  if (!column)
    throw Error(
        fmt::format("{}: column '{}' is missing; found: {}", csv_.name, key, fmt::join(csv_.header, ", ")));
  return *column;
}

double PointColumns::azimuth_deg(const CsvRow& row, std::size_t column) const {
  return csv_.number(row, column, -3600, 3600, true);
}

Vec3 PointColumns::polar(const CsvRow& row, std::size_t theta, double phi_deg) const {
  return spherical_direction(csv_.number(row, theta, 0, 90, false) * kPi / 180, phi_deg * kPi / 180);
}

}  // namespace sunbeam
