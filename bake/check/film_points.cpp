#include "bake/check/film_points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <ostream>

#include "bake/optics/dispersion/optical_index.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/film_stack.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr double kThickest = 100000;

std::size_t require(const Csv& csv, const char* key) {
  if (const auto column = csv.column(key)) return *column;
  throw Error(fmt::format(
      "{}: column '{}' is missing; 'layers' are evaluated at one wavelength and angle a row", csv.name, key));
}

void refuse_other_keys(const Csv& csv) {
  for (const auto& name : csv.header)
    for (const auto& key : material_keys())
      if (name == key && key != "exterior_ior" && key != "base_ior" && key != "base_extinction")
        throw Error(
            fmt::format("{}: column '{}' stands beside 'layers'; allowed: exterior_ior, base_ior, "
                        "base_extinction, theta_i_deg, wavelength_nm",
                        csv.name, name));
}

// "thickness_nm/ior/extinction".
FilmLayer layer_of(const std::string& text) {
  const auto parts = split(text, '/');
  double d = 0, n = 0, k = 0;
  if (parts.size() != 3 || !parse_number(parts[0], d) || !parse_number(parts[1], n) ||
      !parse_number(parts[2], k) ||
      !(d >= 0 && d <= kThickest && n >= kLeastIor && n <= kLargestIor && k >= 0 && k <= kMostExtinction))
    throw Error(fmt::format(
        "column 'layers': found '{}'; allowed: thickness_nm/ior/extinction, 0 to {:g} / {:g} to {:g} / "
        "0 to {:g}",
        text, kThickest, kLeastIor, kLargestIor, kMostExtinction));
  return {d, {n, k}};
}

std::vector<FilmLayer> layers_of(const std::string& text) {
  std::vector<FilmLayer> layers;
  if (trimmed(text).empty()) return layers;
  for (const auto& layer : split(text, ';')) layers.push_back(layer_of(layer));
  return layers;
}

// A base of its own index has no n at one wavelength to keep beside a column of k, nor the other way round.
void require_whole_base(const Csv& csv) {
  const auto ior = csv.column("base_ior"), extinction = csv.column("base_extinction");
  if (ior.has_value() == extinction.has_value()) return;
  throw Error(
      fmt::format("{}: column '{}' stands alone, and the recipe's base has an index over the "
                  "wavelength; allowed: base_ior and base_extinction together, or neither",
                  csv.name, ior ? "base_ior" : "base_extinction"));
}

// The columns of one CSV, found once.
class FilmRows {
 public:
  FilmRows(const Material& material, const FilmDesign& film, const Csv& csv)
      : material_(material),
        film_(film),
        csv_(csv),
        layers_(require(csv, "layers")),
        theta_(require(csv, "theta_i_deg")),
        wavelength_(require(csv, "wavelength_nm")) {
    refuse_other_keys(csv);
    if (film_.base) require_whole_base(csv);
  }

  // The results as text, each behind a comma.
  std::string results(const CsvRow& row) const {
    const double cosine = std::cos(csv_.number(row, theta_, 0, 90, false) * kPi / 180);
    const double nm = csv_.number(row, wavelength_, 100, 10000, true);
    const FilmStack layers = stack(row, nm);
    const StackPower power = stack_power(layers, cosine, nm);
    const auto below = reflectance_below(layers, cosine, nm);
    return fmt::format(",{:.17g},{:.17g},{}", power.reflectance, power.transmittance,
                       below ? fmt::format("{:.17g}", *below) : "");
  }

 private:
  FilmStack stack(const CsvRow& row, double nm) const {
    const Interval exterior = allowed_interval("exterior_ior");
    FilmStack stack;
    stack.exterior_ior = number(row, "exterior_ior", exterior.low, exterior.high, material_.exterior_ior);
    stack.base_index = {number(row, "base_ior", kLeastIor, kLargestIor, material_.base_ior),
                        number(row, "base_extinction", 0, kMostExtinction, material_.base_extinction)};
    try {
      if (film_.base && !csv_.column("base_ior")) stack.base_index = film_.base_at(nm);
      stack.layers = layers_of(row.cells[layers_]);
    } catch (const Error& error) {
      throw Error(fmt::format("{}:{}: {}", csv_.name, row.line, error.what()));
    }
    return stack;
  }

  double number(const CsvRow& row, const char* key, double low, double high, double fallback) const {
    const auto column = csv_.column(key);
    return column ? csv_.number(row, *column, low, high, true) : fallback;
  }

  const Material& material_;
  const FilmDesign& film_;
  const Csv& csv_;
  std::size_t layers_, theta_, wavelength_;
};

constexpr std::array kResults = {"reflectance", "transmittance", "reflectance_below"};

}  // namespace

bool holds_film_points(const Csv& csv, Quantity quantity) {
  if (csv.column("layers") && quantity != Quantity::film)
    throw Error(csv.name + ": column 'layers' is evaluated by --quantity film alone");
  return csv.column("layers").has_value();
}

void evaluate_film_points(const Material& material, const FilmDesign& film, const Csv& csv,
                          std::ostream& out) {
  for (const char* name : kResults)
    if (csv.column(name))
      throw Error(fmt::format("{}: column '{}' has the name of an output column", csv.name, name));
  const FilmRows rows(material, film, csv);
  std::string text = fmt::format("{},{}\n", csv_line(csv.header), fmt::join(kResults, ","));
  for (const CsvRow& row : csv.rows) text += csv_line(row.cells) + rows.results(row) + "\n";
  out << text;
}

}  // namespace sunbeam
