// The general tabulation alone: a dense table whose array holds the rest itself, with no closed form in front
// of it.
#include "bake/check/verify.h"
#include "sunbeam/table_io.h"
#include "tests/accuracy/support.h"

namespace sunbeam {
namespace {

// The default recipe at one parameter point.
Recipe frameless(double film_thickness_nm, double base_ior, double absorption_per_nm) {
  return load_recipe(std::string(SUNBEAM_SOURCE_DIR) + "/tables/recipes/sunbeam.toml",
                     {"table.encoding=dense", "table.frame=none", "accuracy.noise=0.002",
                      "grid.film_thickness_nm=[" + to_text(film_thickness_nm) + "]",
                      "grid.base_ior=[" + to_text(base_ior) + "]",
                      "grid.absorption_per_nm=[" + to_text(absorption_per_nm) + "]"});
}

struct Point {
  double film_thickness_nm, base_ior, absorption_per_nm;
};

class Frameless : public ::testing::TestWithParam<Point> {};

// 0.2 % in the median and 1 % at the 99th percentile, in a file of at most 1 MB.
TEST_P(Frameless, MeetsItsGoalWithoutClosedForms) {
  const auto [film_thickness_nm, base_ior, absorption_per_nm] = GetParam();
  const Table table = bake_table(frameless(film_thickness_nm, base_ior, absorption_per_nm), {});
  EXPECT_EQ(table.frame, FrameKind::none);
  EXPECT_TRUE(table.film_transmittance.empty());
  EXPECT_TRUE(table.first_visit.empty());
  const std::string file = table_exr_bytes(table);
  EXPECT_LE(file.size(), 1u << 20);
  EXPECT_TRUE(parse_table_exr(file, "t") == table);
  VerifySettings settings;
  settings.points = 40;
  settings.truth = Estimator::exact;
  const VerifyReport report = verify(table, settings);
  EXPECT_LT(report.error.median, 0.002);
  EXPECT_LT(report.error.p99, 0.01);
  EXPECT_LT(report.reciprocity_max, 1e-6);  // look-ups in single floats
}

// The sliders' defaults, and a thick film over a pale base, where the rest is most of the light.
INSTANTIATE_TEST_SUITE_P(Each, Frameless, ::testing::Values(Point{400, 1, 0.7}, Point{900, 1.5, 0.05}));

// One number a cell, to three binary digits.
TEST(DenseTable, ErrorsAreCoarse) {
  const Table& table = test::baked(test::SmallRecipe());
  ASSERT_EQ(table.rest_stderr.channels(), 1u);
  int exponent = 0;
  for (const float error : table.rest_stderr.values()) {
    EXPECT_GT(error, 0);
    EXPECT_EQ(8 * std::frexp(error, &exponent), std::round(8 * std::frexp(error, &exponent)));
  }
}

}  // namespace
}  // namespace sunbeam
