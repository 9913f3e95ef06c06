// The noise that a factored table states is the spread of tables baked with other seeds.
#include "bake/factored/axes.h"
#include "tests/accuracy/support.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

constexpr std::uint64_t kSeeds = 48;
constexpr double kDarkest = 0.002 * kInvPi;  // noise of darker values is relative to this

Recipe recipe_of(const std::string& transmission, const std::string& path) {
  test::SmallRecipe small;
  small.exterior_ior = 1.33;
  small.transmission = transmission;
  small.path = path;
  small.roughness = 0.3;
  small.albedo_text = "[0.8, 0.4, 0.1]";
  std::string text = small.text();
  const std::string dense = "encoding = \"dense\"";
  text.replace(text.find(dense), dense.size(), "encoding = \"factored\"");
  return parse_recipe(text, "small.toml");
}

std::vector<TableBsdf> bound_tables(const Recipe& recipe) {
  std::vector<TableBsdf> tables;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
    tables.push_back(test::bsdf_of(bake_table(recipe, {.seed = seed, .threads = 0, .on_progress = {}})));
  return tables;
}

// Root mean square of z over pairs of different nodes, whose walks are independent, as far as they are not
// dark. It is that of the channels' mean, for they share their walks.
double spread_of_z(const std::vector<TableBsdf>& tables, const std::vector<double>& cosines) {
  test::RunningMean square_of_z;
  for (std::size_t i = 0; i < cosines.size(); ++i)
    for (std::size_t o = i + 1; o < cosines.size(); ++o) {
      const Vec3 wi = direction_from_cosine(cosines[i], 0), wo = direction_from_cosine(cosines[o], 0);
      test::RunningMean value, variance;
      for (const TableBsdf& table : tables) {
        value.add(mean(table.rest(wo, wi)));
        variance.add(square(mean(table.rest_stderr(wo, wi))));
      }
      if (value.mean() > kDarkest) square_of_z.add(value.variance() / variance.mean());
    }
  return std::sqrt(square_of_z.mean());
}

// A table states one number, the root mean square over all its cells: less than the noise at grazing, more
// than that of other directions, so that z over the bright pairs is 0.75 to 1.08. 48 seeds by 8 nodes are 376
// degrees of freedom, a relative deviation of 3.6 %; the bounds are more than four of them away.
TEST(FactoredNoise, IsTheSpreadOverSeeds) {
  for (const std::string transmission : {"straight", "refract"})
    for (const std::string path : {"sum", "product"}) {
      const Recipe recipe = recipe_of(transmission, path);
      const double spread = spread_of_z(bound_tables(recipe), direction_axes(recipe, "")[0].nodes);
      EXPECT_GT(spread, 0.6) << transmission << ' ' << path;
      EXPECT_LT(spread, 1.3) << transmission << ' ' << path;
    }
}

}  // namespace
}  // namespace sunbeam
