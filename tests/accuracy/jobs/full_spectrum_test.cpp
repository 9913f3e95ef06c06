// Tables of folded spectra: against the live model, in both file forms, in both colour spaces.
#include <gtest/gtest.h>

#include "bake/check/verify.h"
#include "sunbeam/table_io.h"
#include "sunbeam/table_vdb.h"
#include "tests/accuracy/support.h"

namespace sunbeam {
namespace {

struct Case {
  std::string name, albedo, material, spectrum;
};

const Case kCases[] = {
    {"grey", "0.5", "", ""},
    {"eumelanin", "[0.7, 0.4, 0.2]", "absorption_spectrum = \"eumelanin\"", ""},
    {"orange", "[[400, 0.05], [550, 0.1], [600, 0.9], [700, 0.95]]",
     "absorption_spectrum = [[400, 3.0], [510, 1.0], [700, 0.2]]", ""},
    {"orange in Rec.709", "[[400, 0.05], [550, 0.1], [600, 0.9], [700, 0.95]]",
     "absorption_spectrum = \"pheomelanin\"", "color_space = \"rec709\"\nilluminant = \"E\""},
};

test::SmallRecipe recipe_of(const Case& c, double roughness) {
  test::SmallRecipe recipe;
  recipe.roughness = roughness;
  recipe.albedo_text = c.albedo;
  recipe.material = c.material;
  recipe.spectrum = "mode = \"full\"\n" + c.spectrum;
  recipe.cosines = 6;
  recipe.noise = 0.02;
  // Strong absorption at one end: what spectra add to the table is seen there.
  recipe.grid = "absorption_per_nm = {from = 0.0, to = 1.0, count = 4}";
  return recipe;
}

VerifyReport verify_exactly(const Table& table, int points) {
  VerifySettings settings;
  settings.points = points;
  settings.truth = Estimator::exact;
  return verify(table, settings);
}

// The first visit is exact for a smooth film whatever the pigment's spectrum; the walks' noise is 2 % of what
// remains. Interpolation on this coarse grid gives up to 2 %.
TEST(FullSpectrumTable, AgreesWithTheExactModel) {
  for (const Case& c : kCases) {
    const VerifyReport report = verify_exactly(test::baked(recipe_of(c, 0)), 60);
    EXPECT_LT(report.error.median, 0.03) << c.name;
    EXPECT_LT(report.error.p99, 0.08) << c.name;
    EXPECT_LT(report.dirac_error_p99, 0.003) << c.name;
    EXPECT_LT(report.reciprocity_max, 1e-5) << c.name;  // look-ups in single floats
    EXPECT_LT(report.energy_max, 1.02) << c.name;
  }
}

TEST(FullSpectrumTable, SurvivesBothFileForms) {
  for (const Case& c : kCases) {
    const Table& table = test::baked(recipe_of(c, 0));
    const Table exr = parse_table_exr(table_exr_bytes(table), "t"),
                vdb = parse_table_vdb(table_vdb_bytes(table), "t");
    EXPECT_TRUE(exr == table) << c.name;
    EXPECT_TRUE(vdb == table) << c.name;
    EXPECT_TRUE(exr.is_full_spectrum());
    EXPECT_EQ(exr.color_space(), c.spectrum.empty() ? ColorSpace::acescg : ColorSpace::rec709);
    EXPECT_EQ(exr.info.at("illuminant"), c.spectrum.empty() ? "D65" : "E");
    EXPECT_FALSE(exr.first_visit.empty());
  }
}

// A saturated base outside Rec.709 keeps its negative channel through the table.
TEST(FullSpectrumTable, KeepsNegativeComponents) {
  test::SmallRecipe recipe =
      recipe_of({"", "[[480, 0.0], [490, 0.9], [510, 0.9], [520, 0.0]]", "", "color_space = \"rec709\""}, 0);
  recipe.grid = "";
  recipe.absorption_per_nm = 0;
  const TableBsdf bsdf = test::bsdf_of(test::baked(recipe));
  const Rgb rest = bsdf.rest(spherical_direction(0.5, 0), spherical_direction(0.4, 1));
  EXPECT_LT(rest.r, -0.005);
  EXPECT_GT(rest.g, 0.02);
  Rng rng(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const auto sample = bsdf.sample(spherical_direction(0.5, 0), rng);
    EXPECT_TRUE(!sample || is_finite(sample->throughput));
  }
}

}  // namespace
}  // namespace sunbeam
