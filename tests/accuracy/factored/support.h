// Factored tables of the shipped recipe's film over every kind of surface, baked when a test first asks.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "bake/jobs/bake.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam::test {

struct FilmRow {
  std::string roughness, transmission, path;

  friend void PrintTo(const FilmRow& row, std::ostream* out) { *out << row.name(); }
  bool is_plain() const { return roughness.front() != '['; }
  bool is_smooth() const { return roughness == "0"; }
  std::string name() const {
    const std::string surface = !is_plain()   ? "anisotropic"
                                : is_smooth() ? "smooth"
                                              : "rough0" + roughness.substr(2);
    return surface + "_" + transmission + "_" + path;
  }
};

// Smooth, a little and more rough, straight and bending, both paths through the pigment.
inline std::vector<FilmRow> plain_rows() {
  std::vector<FilmRow> rows;
  for (const char* roughness : {"0", "0.1", "0.3"})
    for (const char* transmission : {"straight", "refract"})
      for (const char* path : {"sum", "product"}) rows.push_back({roughness, transmission, path});
  return rows;
}

inline std::vector<FilmRow> all_rows() {
  auto rows = plain_rows();
  for (const char* path : {"sum", "product"}) rows.push_back({"[0.1, 0.3]", "refract", path});
  return rows;
}

inline Recipe recipe_of(const FilmRow& row, const std::string& spectrum,
                        const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> all = {"table.encoding=factored", "material.roughness=" + row.roughness,
                                  "material.transmission=" + row.transmission,
                                  "material.absorption_path=" + row.path, "spectrum.mode=" + spectrum};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return load_recipe(std::string(SUNBEAM_SOURCE_DIR) + "/tables/recipes/sunbeam.toml", all);
}

// The whole grid of the recipe unless `overrides` say otherwise.
inline const Table& factored(const FilmRow& row, const std::string& spectrum,
                             const std::vector<std::string>& overrides = {}) {
  static std::map<std::string, Table> cache;
  const Recipe recipe = recipe_of(row, spectrum, overrides);
  if (!cache.count(recipe.text))
    cache[recipe.text] = bake_table(recipe, {.seed = 1, .threads = 0, .on_progress = {}});
  return cache.at(recipe.text);
}

// The lower five of the recipe's ten base IORs, (k/9)^2 above 1, in half the time and half the bytes.
inline const Table& lower_half(const FilmRow& row, const std::string& spectrum) {
  return factored(row, spectrum, {"grid.base_ior={from=1.0, to=1.1975308641975309, count=5}"});
}

// What is asked of the lower half of a row's table at all wavelengths, in several files.
class FactoredTable : public ::testing::TestWithParam<FilmRow> {
 protected:
  static const Table& table() { return lower_half(GetParam(), "full"); }
};

inline std::string name_of_row(const ::testing::TestParamInfo<FilmRow>& info) { return info.param.name(); }

}  // namespace sunbeam::test
