// The plan of a bake: nodes where they are needed, the same everywhere, within limits.
#include "bake/jobs/plan.h"

#include "bake/check/verify.h"
#include "bake/jobs/bake.h"
#include "tests/accuracy/support.h"

namespace sunbeam {
namespace {

constexpr const char* kCoarse =
    "[material]\nroughness = 0.2\nfilm_thickness_nm = 300\nbase_ior = 1.4\nabsorption_per_nm = 0.1\n"
    "pigment_thickness_nm = 2\nalbedo = 0.6\n"
    "[grid]\nfilm_thickness_nm = [200, 400]\nbase_ior = [1.0, 1.5, 2.0]\nabsorption_per_nm = [0, 1.2]\n"
    "[table]\nencoding = \"factored\"\nangles = 5\n[accuracy]\nnoise = 0.005\n";

Recipe coarse(const std::vector<std::string>& overrides) {
  return parse_recipe(kCoarse, "coarse.toml", overrides);
}

Quantiles errors_of(const Recipe& recipe) {
  VerifySettings settings;
  settings.points = 30;
  settings.truth = Estimator::exact;
  return verify(bake_table(recipe, {}), settings).error;
}

TEST(Plan, NothingToDoWithoutATarget) {
  const Recipe recipe = coarse({});
  const Plan plan = plan_bake(recipe, {});
  EXPECT_EQ(plan.recipe.text, recipe.text);
  EXPECT_TRUE(plan.summary.empty());
}

TEST(Plan, MeetsItsTargetAtHeldOutPoints) {
  const Plan plan = plan_bake(coarse({"accuracy.interpolation=0.01"}), {});
  EXPECT_EQ(plan.summary.find("limited"), std::string::npos) << plan.summary;
  EXPECT_GT(plan.recipe.grid[1].size(), 3u);
  EXPECT_GT(plan.recipe.grid[2].size(), 2u);
  EXPECT_EQ(plan.recipe.accuracy.interpolation, 0);
  const Quantiles before = errors_of(coarse({})), after = errors_of(plan.recipe);
  EXPECT_GT(before.p95, 0.02);
  EXPECT_LT(after.p95, 0.01);
}

TEST(Plan, DependsOnRecipeAndSeedAlone) {
  const Recipe recipe = coarse({"accuracy.interpolation=0.05"});
  const Plan one = plan_bake(recipe, {.seed = 3, .threads = 1, .on_step = {}});
  const Plan two = plan_bake(recipe, {.seed = 3, .threads = 2, .on_step = {}});
  EXPECT_EQ(one.recipe.text, two.recipe.text);
  EXPECT_EQ(one.summary, two.summary);
  // What is written is what is read.
  EXPECT_EQ(parse_recipe(one.recipe.text, "again").hash, one.recipe.hash);
}

TEST(Plan, StopsAtItsLimits) {
  const Plan plan = plan_bake(coarse({"accuracy.interpolation=0.01", "limits.megabytes=0.01"}), {});
  EXPECT_NE(plan.summary.find("limited"), std::string::npos) << plan.summary;
  EXPECT_LE(bytes_of(plan.recipe, Encoding::factored), 0.01e6);
}

// A dense table needs nodes for its fringes; a factored one has them in its fringe orders.
TEST(Plan, ThicknessIsRefinedWhereItIsTabulated) {
  const std::vector<std::string> common{"accuracy.interpolation=0.003", "grid.base_ior=[1.4]",
                                        "grid.absorption_per_nm=[0.1]"};
  EXPECT_EQ(plan_bake(coarse(common), {}).recipe.grid[0].size(), 2u);
  auto dense = common;
  dense.insert(dense.end(), {"table.encoding=dense", "accuracy.noise=0.02", "table.angles=8"});
  EXPECT_GT(plan_bake(coarse(dense), {}).recipe.grid[0].size(), 2u);
}

TEST(Plan, PreviewIsASmallTableOfTheSameMaterial) {
  const Recipe recipe = coarse({}), preview = preview_of(recipe);
  EXPECT_EQ(preview.material.base_ior, recipe.material.base_ior);
  EXPECT_EQ(preview.grid[1].low(), recipe.grid[1].low());
  EXPECT_EQ(preview.grid[1].high(), recipe.grid[1].high());
  EXPECT_LE(bytes_of(preview, Encoding::factored), bytes_of(recipe, Encoding::factored));
  EXPECT_LT(errors_of(preview).median, 0.01);
}

}  // namespace
}  // namespace sunbeam
