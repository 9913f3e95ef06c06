// The preview of a recipe: small, quick, and of the same material.
#include "bake/jobs/preview.h"

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

Quantiles errors_of(const Recipe& recipe) {
  VerifySettings settings;
  settings.points = 30;
  settings.truth = Estimator::exact;
  return verify(bake_table(recipe, {}), settings).error;
}

TEST(Preview, IsASmallTableOfTheSameMaterial) {
  const Recipe recipe = parse_recipe(kCoarse, "coarse.toml"), preview = preview_of(recipe);
  EXPECT_EQ(preview.material.base_ior, recipe.material.base_ior);
  EXPECT_EQ(preview.grid[1].low(), recipe.grid[1].low());
  EXPECT_EQ(preview.grid[1].high(), recipe.grid[1].high());
  EXPECT_LE(bytes_of(preview, Encoding::factored), bytes_of(recipe, Encoding::factored));
  EXPECT_LT(errors_of(preview).median, 0.01);
}

}  // namespace
}  // namespace sunbeam
