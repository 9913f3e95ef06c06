// Tables of layered films, of random content, of every kind that either encoding knows.
#pragma once

#include <algorithm>

#include "tests/table/factored_tables.h"

namespace sunbeam::test {

// Two layers of five wavelengths, the upper one dispersive and the lower one absorbing, in three periods.
inline void add_layers(Wavelengths& waves) {
  waves.film_periods = 3;
  for (std::size_t k = 0; k < waves.size(); ++k) {
    const double x = static_cast<double>(k) / 3;
    waves.layers.push_back({{100.0 / 3, 1.7 - 0.1 * x}, {50, {1.3, 0.01 * x}}});
  }
}

inline Axis rank_axis() { return cubic_axis("facet_rank", {0, 0.25, 0.5, 1}); }

// Rises along the last axis.
inline void fill_ascending(NdArray& array, std::uint64_t stream) {
  fill_randomly(array, 0, 1, stream);
  const auto ranks = static_cast<std::ptrdiff_t>(array.axes().back().size());
  for (auto row = array.values().begin(); row != array.values().end(); row += ranks)
    std::sort(row, row + ranks);
}

inline void add_facets(Table& table) {
  const bool isotropic = table.symmetry == Symmetry::isotropic;
  const Axis phi = isotropic ? axis("phi", {0}) : cubic_axis("phi", {0, kPi / 4, kPi / 2});
  const std::vector<Axis> facets{cubic_axis("theta", {0, 0.5, 1, 1.57}), phi, rank_axis()};
  const bool is_straight = table.material.transmission == Transmission::straight;
  std::vector<Axis> axes{table.factors.grid[1],
                         is_straight ? axis("optical_depth", {0}) : cubic_axis("optical_depth", {0, 0.3}, 3)};
  axes.insert(axes.end(), facets.begin(), facets.end());
  table.factors.facet_cosine = NdArray("facet_cosine", facets, Precision::single_float, 1);
  table.factors.crossing = NdArray("crossing", axes, Precision::single_float, 1);
  fill_ascending(table.factors.facet_cosine, 11);
  fill_randomly(table.factors.crossing, -1, 0, 12);
}

inline void add_returning(Table& table) {
  Axis ranks = rank_axis(), depths = cubic_axis("optical_depth", {0, 0.3, 0.6}, 3);
  if (table.material.is_opaque()) ranks.nodes = {1}, depths.nodes = {0};
  table.factors.return_cosine = NdArray("return_cosine", {ranks}, Precision::single_float, 1);
  table.factors.returning = NdArray("returning", {depths, ranks}, Precision::single_float, 1);
  fill_ascending(table.factors.return_cosine, 13);
  fill_randomly(table.factors.returning, 0, 1, 14);
}

inline void add_layered_exchange(Table& table) {
  add_exchange(table, Precision::half_float);
  std::vector<Axis> axes = table.factors.exchange.axes();
  axes.insert(axes.begin() + 3, cubic_axis("wavelength_nm", {400, 500, 600}));
  const bool is_warped = !table.material.is_smooth() && table.material.exterior_ior > 1;
  for (const std::size_t k : {5u, 7u})
    if (is_warped) axes[k] = cubic_axis(k == 5 ? "warped_cos_i" : "warped_cos_o", {0, 0.5, 1});
  table.factors.exchange = NdArray("exchange", axes, Precision::half_float, 1);
  fill_randomly(table.factors.exchange, -0.1, 1, 15);
}

// The arrays that a layered film of this material needs.
inline Table layered_table(const Material& material, const Wavelengths& waves) {
  Table table = small_factored_table(material.roughness, material.absorption_path);
  table.schema_version = kTableSchemaVersion;
  table.material = material;
  table.factors = small_factors();
  table.factors.wavelengths = waves;
  if (!waves.base_index.empty() || material.is_opaque()) table.factors.grid[1].nodes = {material.base_ior};
  table.factors.grid[1].origin = material.exterior_ior;
  if (!material.is_smooth() && !material.is_opaque()) add_facets(table);
  if (material.absorption_path == AbsorptionPath::sum || material.is_opaque())
    add_returning(table);
  else
    add_layered_exchange(table);
  return table;
}

inline Material material_of(const Roughness& roughness, AbsorptionPath path) {
  Material material;
  material.roughness = roughness;
  material.absorption_path = path;
  return material;
}

inline Wavelengths layered_waves() {
  Wavelengths waves = small_factors().wavelengths;
  add_layers(waves);
  return waves;
}

// Rough, of path "sum", over a clear base.
inline Table layered_table() { return layered_table(material_of(0.3, AbsorptionPath::sum), layered_waves()); }

// Layers over gold: the film is rough, and there is no rest.
inline Table layered_opaque_table() {
  Material material = material_of(0.3, AbsorptionPath::product);
  material.base_ior = 0.3;
  material.base_extinction = 3;
  material.albedo = Rgb(0);
  material.absorption_per_nm = 0;
  Wavelengths waves = layered_waves();
  for (std::size_t k = 0; k < waves.size(); ++k) waves.base_index.push_back({0.2 + 0.3 * double(k), 3});
  return layered_table(material, waves);
}

// One uneven layer over a dispersive base.
inline Table layered_dispersive_table() {
  Material material = material_of(0, AbsorptionPath::sum);
  material.thickness_spread = 0.1;
  Wavelengths waves = small_factors().wavelengths;
  for (std::size_t k = 0; k < waves.size(); ++k) waves.base_index.push_back(1.6 - 0.02 * double(k));
  return layered_table(material, waves);
}

// Their arrays say all of the film.
inline Table layered_dense_table(bool rough) {
  Table table = small_table(Precision::half_float, rough);
  table.schema_version = kTableSchemaVersion;
  if (rough) table.material.thickness_spread = 0.2;
  table.film_transmittance = NdArray("film_transmittance", small_film_axes(), Precision::single_float);
  fill_randomly(table.film_transmittance, 0, 1, 3);
  return table;
}

inline std::vector<Table> layered_tables() {
  std::vector<Table> tables{layered_opaque_table(), layered_dispersive_table(), layered_dense_table(false),
                            layered_dense_table(true)};
  for (const Roughness& roughness : {Roughness(0), Roughness(0.3), Roughness(0.3, 0.1)})
    for (const AbsorptionPath path : {AbsorptionPath::sum, AbsorptionPath::product})
      tables.push_back(layered_table(material_of(roughness, path), layered_waves()));
  Material material = material_of(0.3, AbsorptionPath::sum);
  material.transmission = Transmission::straight;
  tables.push_back(layered_table(material, layered_waves()));
  material = material_of(0.3, AbsorptionPath::product);
  material.exterior_ior = 1.5;  // the highest base IOR
  tables.push_back(layered_table(material, layered_waves()));
  return tables;
}

}  // namespace sunbeam::test
