// Factored tables of random content, of every kind that the encoding knows.
#pragma once

#include "tests/table/support.h"

namespace sunbeam::test {

inline Axis cubic_axis(std::string name, std::vector<double> nodes, double power = 1) {
  return {std::move(name), "1", std::move(nodes), power, 0, 0, true};
}

// The parameters, two wavelengths more than rgb3 has, and no meaning.
inline Factors small_factors() {
  Factors factors;
  factors.grid = {axis("film_thickness_nm", {200, 300, 400}), Axis{"base_ior", "1", {1.4, 1.5}, 2, 0, 1},
                  Axis{"absorption_per_nm", "1/nm", {0, 0.1}, 3}};
  factors.wavelengths = {{400, 450, 500, 550, 1.0 / 3 + 600},
                         {0.1, 0.2, 0.3, 0.4, 0.5},
                         {3, 1.5, 1, 0.7, 0},
                         {{0.1, 0, 0.5}, {0.2, -0.1, 0.4}, {0, 0.6, 0.1}, {0.3, 0.4, 0}, {0.4, 0.1, 0}}};
  return factors;
}

inline void add_arrival(Table& table, Precision precision) {
  const bool isotropic = table.symmetry == Symmetry::isotropic;
  const Axis phi = isotropic ? axis("phi", {0}) : cubic_axis("phi", {0, kPi / 4, kPi / 2});
  table.factors.arrival = NdArray(
      "arrival",
      {table.factors.grid[1], cubic_axis("optical_depth", {0, 0.3, 0.6}, 3),
       cubic_axis("fringe_order", {0.5, 1, 2, 3, 4}), cubic_axis("cos_theta", {1e-3, 0.5, 1}, 2), phi},
      precision, 1);
  fill_randomly(table.factors.arrival, -3, 0, 5);
}

inline void add_returned(Table& table) {
  table.factors.returned = NdArray("returned",
                                   {table.factors.grid[1], cubic_axis("optical_depth", {0, 0.3, 0.6}, 3),
                                    cubic_axis("fringe_order", {0.5, 1, 2, 3, 4})},
                                   Precision::single_float, 1);
  fill_randomly(table.factors.returned, 0, 1, 6);
}

inline void add_exchange(Table& table, Precision precision) {
  const bool isotropic = table.symmetry == Symmetry::isotropic;
  std::vector<Axis> axes = {table.factors.grid[1], cubic_axis("optical_depth", {0, 0.3, 0.6}, 3),
                            cubic_axis("albedo", {0.1, 0.3, 0.5}),
                            cubic_axis("fringe_order", {0.5, 1, 2, 3})};
  for (const std::string end : {"_i", "_o"}) {
    axes.push_back(cubic_axis("cos_theta" + end, {1e-3, 0.5, 1}, 2));
    axes.push_back(isotropic ? axis("phi" + end, {0}) : cubic_axis("phi" + end, {0, kPi / 4, kPi / 2}));
  }
  table.factors.exchange = NdArray("exchange", axes, precision, 1);
  fill_randomly(table.factors.exchange, -0.1, 1, 7);
}

inline Table small_factored_table(const Roughness& roughness, AbsorptionPath path,
                                  Precision precision = Precision::half_float) {
  Table table;
  table.material.roughness = roughness;
  table.material.absorption_path = path;
  table.symmetry = roughness.is_isotropic() ? Symmetry::isotropic : Symmetry::anisotropic;
  table.factors = small_factors();
  if (!table.material.is_smooth()) add_arrival(table, precision);
  path == AbsorptionPath::sum ? add_returned(table) : add_exchange(table, precision);
  table.info = complete_info();
  table.info["encoding"] = "factored";
  table.info["noise"] = "0.000123";
  table.info["error.error_median"] = "0.0125";
  return table;
}

// Rough and with path "sum": arrival and returned.
inline Table small_factored_table() { return small_factored_table(0.3, AbsorptionPath::sum); }

// Both paths over a smooth, a rough and an anisotropic film, of either precision; one of folded spectra.
inline std::vector<Table> factored_tables() {
  std::vector<Table> tables;
  for (const Roughness& roughness : {Roughness(0), Roughness(0.3), Roughness(0.3, 0.1)})
    for (const AbsorptionPath path : {AbsorptionPath::sum, AbsorptionPath::product})
      for (const Precision precision : {Precision::half_float, Precision::single_float})
        tables.push_back(small_factored_table(roughness, path, precision));
  tables.push_back(small_factored_table());
  tables.back().info.merge(std::map<std::string, std::string>{
      {"color_space", "acescg"}, {"illuminant", "D65"}, {"wavelengths", "400 450 500"}});
  tables.back().info["spectrum"] = "full";
  return tables;
}

// Factored tables and dense ones, each of every kind.
inline std::vector<Table> tables_of_every_kind() {
  std::vector<Table> tables = factored_tables();
  for (const bool rough : {false, true}) tables.push_back(small_table(Precision::half_float, rough));
  tables.push_back(small_anisotropic_table());
  tables.push_back(small_full_table());
  return tables;
}

}  // namespace sunbeam::test
