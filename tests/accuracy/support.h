// Small recipes, baked when a test first asks for them.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "bake/jobs/bake.h"
#include "sunbeam/detail/text.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam::test {

// A recipe in few words; one parameter node unless a grid is given. Single precision, so that halves'
// rounding does not hide anything.
struct SmallRecipe {
  std::string transmission = "refract", path = "sum";
  double roughness = 0.1;
  double film_thickness_nm = 350, film_ior = 1.56, base_ior = 1.4;
  double absorption_per_nm = 0.1;  // times 2 nm
  double albedo = 0.7;
  double exterior_ior = 1;
  std::string albedo_text;  // in place of albedo
  std::string material;     // more lines of [material]
  std::string spectrum;     // lines of [spectrum]
  std::string grid;         // lines of [grid]
  int cosines = 8;
  double noise = 0.01;

  std::string text() const {
    return "[material]\ntransmission = \"" + transmission + "\"\nabsorption_path = \"" + path +
           "\"\nroughness = " + to_text(roughness) + "\nfilm_thickness_nm = " + to_text(film_thickness_nm) +
           "\nexterior_ior = " + to_text(exterior_ior) + "\nfilm_ior = " + to_text(film_ior) +
           "\nbase_ior = " + to_text(base_ior) + "\nabsorption_per_nm = " + to_text(absorption_per_nm) +
           "\npigment_thickness_nm = 2\nalbedo = " + (albedo_text.empty() ? to_text(albedo) : albedo_text) +
           "\n" + material + "\n[spectrum]\n" + spectrum + "\n[grid]\n" + grid +
           "\n[table]\nencoding = \"dense\"\nprecision = \"float\"\nangles = " + std::to_string(cosines) +
           "\n[accuracy]\nnoise = " + to_text(noise) + "\n";
  }
  Recipe recipe() const { return parse_recipe(text(), "small.toml"); }
};

inline const Table& baked(const SmallRecipe& recipe) {
  static std::map<std::string, Table> cache;
  const std::string text = recipe.text();
  if (!cache.count(text))
    cache[text] = bake_table(recipe.recipe(), {.seed = 1, .threads = 0, .on_progress = {}});
  return cache.at(text);
}

inline TableBsdf bsdf_of(const Table& table) { return TableBsdf(table, Parameters::of(table.material)); }

struct Configuration {
  std::string name;
  SmallRecipe recipe;
  friend void PrintTo(const Configuration& c, std::ostream* out) { *out << c.name; }
};

// Film surface x transmission x absorption path.
inline std::vector<Configuration> configurations() {
  std::vector<Configuration> result;
  for (const double roughness : {0.0, 0.1, 0.3})
    for (const std::string transmission : {"straight", "refract"})
      for (const std::string path : {"sum", "product"}) {
        SmallRecipe recipe;
        recipe.transmission = transmission;
        recipe.path = path;
        recipe.roughness = roughness;
        const std::string surface = roughness == 0 ? "smooth" : roughness == 0.1 ? "rough01" : "rough03";
        result.push_back({surface + "_" + transmission + "_" + path, recipe});
      }
  return result;
}

// A test that runs once a configuration.
class EachConfiguration : public ::testing::TestWithParam<Configuration> {
 protected:
  const Table& table() const { return baked(GetParam().recipe); }
};

inline std::string configuration_name(const ::testing::TestParamInfo<Configuration>& info) {
  return info.param.name;
}

}  // namespace sunbeam::test
