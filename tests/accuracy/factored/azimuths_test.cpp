// Anisotropic factored tables between their nodes of azimuth, against the exact evaluator.
#include "bake/factored/axes.h"
#include "bake/live/exact/exact.h"
#include "tests/accuracy/factored/support.h"

namespace sunbeam {
namespace {

// One node of every parameter, so that directions alone are interpolated.
Recipe one_point(const std::string& path) {
  return test::recipe_of(
      {"[0.1, 0.4]", "refract", path}, "rgb3",
      {"material.base_ior=1.5", "material.absorption_per_nm=0.3", "grid.film_thickness_nm=[400]",
       "grid.base_ior=[1.5]", "grid.absorption_per_nm=[0.3]", "accuracy.noise=0.0005"});
}

// Cubics are off by 2e-3, straight lines by 6e-3 and more. Neither side has noise but the bake's own.
TEST(Azimuths, AreInterpolatedByCubics) {
  for (const std::string path : {"sum", "product"}) {
    const Recipe recipe = one_point(path);
    const Table table = bake_table(recipe, {.seed = 1, .threads = 0, .on_progress = {}});
    const TableBsdf bsdf(table, Parameters::of(table.material));
    const ExactRest exact(table.material, recipe.spectrum.wavelengths(table.material));
    const std::vector<Axis> axes = direction_axes(recipe, "");
    const Vec3 wo = direction_from_cosine(axes[0].nodes[8], 0);
    for (const std::size_t c : {5u, 7u})
      for (std::size_t p = 0; p + 1 < axes[1].size(); ++p) {
        const Vec3 wi =
            direction_from_cosine(axes[0].nodes[c], (axes[1].nodes[p] + axes[1].nodes[p + 1]) / 2);
        const Rgb expected = exact.rest(wo, wi), found = bsdf.rest(wo, wi);
        EXPECT_NEAR(mean(found) / mean(expected), 1, 3e-3) << path << ' ' << wi.z << ' ' << p;
      }
  }
}

}  // namespace
}  // namespace sunbeam
