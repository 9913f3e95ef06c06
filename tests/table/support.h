// Synthetic tables of known content.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sunbeam/core/error.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/table.h"
#include "sunbeam/table_io.h"
#include "sunbeam/table_vdb.h"
#include "tests/support/scratch_folder.h"

namespace sunbeam::test {

// All file forms behind one face.
struct Form {
  std::string name;
  std::function<std::string(const Table&)> bytes;
  std::function<Table(std::string_view, const std::string&)> parse;
};

inline std::vector<Form> forms() {
#ifdef SUNBEAM_TEST_WITHOUT_VDB
  return {{"exr", table_exr_bytes, parse_table_exr}};
#else
  return {{"exr", table_exr_bytes, parse_table_exr}, {"vdb", table_vdb_bytes, parse_table_vdb}};
#endif
}

// What the reader says about `bytes`, "accepted" if nothing.
inline std::string refusal(const Form& form, const std::string& bytes, const std::string& name) {
  try {
    form.parse(bytes, name);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

// Every outcome but a crash or a wrong table: an Error that names the file, or the very table.
inline void expect_error_or_equal(const Form& form, const std::string& bytes, const std::string& name,
                                  const Table& table, const std::string& what) {
  try {
    EXPECT_TRUE(form.parse(bytes, name) == table) << form.name << ", " << what;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith(name)) << form.name << ", " << what;
  }
}

inline std::map<std::string, std::string> complete_info() {
  return {{"recipe", "[material]\nfilm_ior = 1.5\n"},
          {"recipe_hash", "0123456789abcdef"},
          {"seed", "7"},
          {"samples", "4096"},
          {"estimator", "none"},
          {"spectrum", "rgb3"},
          {"tool_version", "0.0.0"},
          {"encoding", "dense"}};
}

inline Axis axis(std::string name, std::vector<double> nodes, double power = 1, double period = 0) {
  const double first = nodes.empty() ? 0 : nodes.front();
  return {std::move(name), "1", std::move(nodes), power, period, first};
}

// `count` azimuths from 0, without the end that is the beginning again.
inline Axis full_circle(const std::string& name, std::size_t count) {
  std::vector<double> nodes;
  for (std::size_t k = 0; k < count; ++k)
    nodes.push_back(2 * kPi * static_cast<double>(k) / static_cast<double>(count));
  return axis(name, nodes, 1, 2 * kPi);
}

inline std::vector<Axis> small_film_axes() {
  return {axis("film_thickness_nm", {200, 300, 400}), Axis{"base_ior", "1", {1.4, 1.5}, 2, 0, 1},
          axis("cos_theta", {0, 0.5, 1})};
}

inline std::vector<Axis> small_rest_axes() {
  return {axis("film_thickness_nm", {200, 300, 400}),
          Axis{"base_ior", "1", {1.4, 1.5}, 2, 0, 1},
          axis("absorption_per_nm", {0.1}, 3),
          axis("cos_theta_i", {0.01, 0.3, 0.6, 1}),
          axis("phi_i", {0}),
          axis("cos_theta_o", {0.01, 0.3, 0.6, 1}),
          axis("phi_o", {0, kPi / 2, kPi})};
}

// Random in [low, high) with some exact zeros among them.
inline void fill_randomly(NdArray& array, double low, double high, std::uint64_t stream) {
  Rng rng(1, stream);
  const auto draw = [&] { return rng.uniform() < 0.1 ? 0.0 : lerp(rng.uniform(), low, high); };
  for (std::size_t cell = 0; cell < array.cells(); ++cell) {
    const double r = draw(), g = draw(), b = draw();
    array.set(cell, {r, g, b});
  }
}

// Three film thicknesses, two base indices, one absorption; isotropic, without any meaning.
inline Table small_table(Precision precision = Precision::half_float, bool rough = true) {
  Table table;
  table.material.roughness = rough ? 0.3 : 0;
  table.material.albedo = {0.1, 0.2, 1.0 / 3};
  table.film_reflectance = NdArray("film_reflectance", small_film_axes(), Precision::single_float);
  table.remainder = NdArray("remainder", small_rest_axes(), precision);
  table.rest_stderr = NdArray("rest_stderr", small_rest_axes(), precision, 1);
  fill_randomly(table.film_reflectance, 0, 1, 0);
  fill_randomly(table.remainder, -0.01, 0.2, 1);
  fill_randomly(table.rest_stderr, 0, 0.001, 2);
  if (rough) {
    table.film_transmittance = NdArray("film_transmittance", small_film_axes(), Precision::single_float);
    fill_randomly(table.film_transmittance, 0, 1, 3);
  }
  table.info = complete_info();
  table.info["error.error_median"] = "0.0125";
  return table;
}

// small_table() of an anisotropic film.
inline Table small_anisotropic_table(Precision precision = Precision::half_float) {
  Table table = small_table(precision);
  table.symmetry = Symmetry::anisotropic;
  table.material.roughness = {0.3, 0.1};
  auto axes = small_rest_axes();
  axes[4] = axis("phi_i", {0, kPi / 4, kPi / 2});
  axes[6] = full_circle("phi_o", 8);
  table.remainder = NdArray("remainder", axes, precision);
  table.rest_stderr = NdArray("rest_stderr", axes, precision, 1);
  fill_randomly(table.remainder, -0.01, 0.2, 1);
  fill_randomly(table.rest_stderr, 0, 0.001, 2);
  return table;
}

// small_table() with folded spectra.
inline Table small_full_table() {
  Table table = small_table();
  table.first_visit = NdArray("first_visit", {axis("optical_path", {0, 1, 10}, 3)}, Precision::single_float);
  fill_randomly(table.first_visit, -0.01, 0.5, 4);
  table.info.merge(std::map<std::string, std::string>{
      {"color_space", "acescg"}, {"illuminant", "D65"}, {"wavelengths", "400 500 600"}});
  table.info["spectrum"] = "full";
  return table;
}

}  // namespace sunbeam::test
