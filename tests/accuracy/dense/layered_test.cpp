// Dense tables of layered films against the live model, by both look-ups.
#include <gtest/gtest.h>

#include "bake/check/verify.h"
#include "bake/jobs/bake.h"

namespace sunbeam {
namespace {

struct Case {
  std::string name, text;
  Estimator truth;
  double median, p99;  // bounds of the error
  int points = 16;
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

std::string recipe(const std::string& material, const std::string& layers, const std::string& grid,
                   const std::string& more) {
  return "[material]\n" + material + layers + "\n[grid]\n" + grid +
         "\n[table]\nencoding = \"dense\"\nangles = 12\n" + more;
}
std::string layer(const std::string& nm, const std::string& index) {
  return "\n[[material.film]]\nthickness_nm = " + nm + "\n" + index;
}

const std::string kClearStack = layer("80", "ior = 2.2") + layer("110", "ior = 1.4");
const std::string kDarkStack = layer("80", "ior = 1.56") + layer("70", "ior = 1.7\nextinction = 0.05");
const std::string kSlab =
    "base_ior = 1.5\nalbedo = 0.5\npigment_thickness_nm = 1000\nscattering_per_nm = 0.0015\n"
    "anisotropy = 0.5\nabsorption_per_nm = 0.0005\nfilm_periods = 3\n";
const std::string kSlabGrid = "absorption_per_nm = {from = 0, to = 0.002, count = 12}\n";
const std::string kSixLayers = kSlab + "roughness = ";

// Walked tables have their own noise, and walks as truth have theirs: at most half the bound of the median.
std::vector<Case> cases() {
  return {
      {"slab_under_six_layers", recipe(kSixLayers + "0.15", kClearStack, kSlabGrid, "azimuths = 7"),
       Estimator::exact, 0.001, 0.01},
      {"slab_under_six_smooth_layers", recipe(kSixLayers + "0", kClearStack, kSlabGrid, "azimuths = 7"),
       Estimator::exact, 0.005, 0.015},
      {"slab_under_absorbing_layers",
       recipe(kSixLayers + "0.15", kDarkStack,
              kSlabGrid + "film_thickness_nm = {from = 420, to = 450, count = 4}\n", "azimuths = 7"),
       Estimator::exact, 0.002, 0.01},
      {"absorbing_smooth_layers",
       recipe("base_ior = 1.5\nalbedo = 0.6\nroughness = 0\nfilm_periods = 4\n", kDarkStack,
              "absorption_per_nm = {from = 0, to = 0.5, count = 5}\n", "[accuracy]\nnoise = 0.004\n"),
       Estimator::exact, 0.004, 0.01},
      {"many_facets_on_metal",
       recipe("base_ior = \"Au\"\nroughness = 0.4\nmicrofacet = \"multiple\"\n", layer("90", "ior = 2.2"), "",
              "azimuths = 4\n[accuracy]\nnoise = 0.2\n"),
       Estimator::pfmc, 0.03, 0.06, 6},
  };
}

class LayeredDense : public ::testing::TestWithParam<Case> {};

TEST_P(LayeredDense, IsTheLiveModel) {
  const Recipe recipe = parse_recipe(GetParam().text, "layered.toml");
  const Table table = bake_table(recipe, BakeSettings{});
  EXPECT_EQ(table.schema_version, kTableSchemaVersion);
  VerifySettings settings = verify_settings_of(recipe);
  settings.points = GetParam().points;
  settings.truth = GetParam().truth;
  settings.tolerance_median = GetParam().median;
  const VerifyReport report = verify(table, settings);
  EXPECT_LT(report.error.median, GetParam().median);
  EXPECT_LT(report.error.p99, GetParam().p99);
  EXPECT_LT(report.textured_error.median, GetParam().median);
  EXPECT_LT(report.textured_error.p99, GetParam().p99);
  EXPECT_LT(report.noise_floor.median, GetParam().median / 2);
  EXPECT_LT(report.dirac_error_p99, 0.002);
  EXPECT_LE(report.energy, 1);
  EXPECT_LT(report.reciprocity_max, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Each, LayeredDense, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace sunbeam
