// The errors that estimators of the rest state: over random materials and directions, every two estimators
// that answer differ by what their errors say, and the others refuse the material by name.
#include <gtest/gtest.h>

#include "bake/check/walked_mean.h"
#include "bake/live/adding_doubling/slab_solver.h"
#include "bake/live/exact/exact.h"
#include "tests/support/csv.h"
#include "tests/support/estimates.h"
#include "tests/support/estimator_sweep.h"
#include "tests/support/random_materials.h"

namespace sunbeam {
namespace {

using test::radians;
using test::SweepCase;

std::vector<SweepCase> draw_cases(int first, int count) {
  return test::draw_cases(31, first, count,
                          [](Rng&, int, const Material& m) { return Wavelengths::rgb3(m); });
}

// 200 materials. Two in three of the scores are independent, and tell the deviation to 0.03: one seed in a
// thousand fails.
TEST(LongStatedErrors, HoldForEveryPairOfEstimators) {
  test::expect_normal(test::compare_rests(draw_cases(0, 200), 3000), 1000, 3, 0.1);
}

// The same for albedos by samples: to 0.035.
TEST(LongStatedErrors, HoldForAlbedos) {
  test::expect_normal(test::compare_albedos(draw_cases(0, 200), 20000), 300, 3, 0.1);
}

// The quick version over other materials; some seventy scores tell the deviation to 0.1.
TEST(StatedErrors, HoldForEveryPairOfEstimators) {
  test::expect_normal(test::compare_rests(draw_cases(200, 12), 1500), 60, 0, 0.3);
}

// Light that all but few facets reflect totally, of roughness 0.05, under a liquid. The exact evaluator is
// good to 1e-3 there. 2 techniques x 2 paths x 3 channels at 4.5 standard errors, 7e-6 each: 8e-5.
TEST(StatedErrors, HoldBeyondTotalReflection) {
  const Vec3 wi = spherical_direction(radians(75), 0), wo = spherical_direction(radians(40), 2);
  for (const auto path : {AbsorptionPath::sum, AbsorptionPath::product}) {
    Material m;
    m.exterior_ior = 1.4;
    m.base_ior = 1.2;
    m.roughness = 0.05;
    m.absorption_path = path;
    const Rgb truth = ExactRest(m, Wavelengths::rgb3(m)).rest(wo, wi);
    const Pfmc pfmc(m);
    for (const Technique technique : test::kTechniques) {
      Rng rng(36, 0);
      const WalkedMean found = walked_mean(10000, [&] { return pfmc.estimate_rest(wo, wi, rng, technique); });
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found.value[c], truth[c], 4.5 * found.standard_error[c] + 1e-3 * truth[c]);
        EXPECT_LE(found.standard_error[c], 0.025 * truth[c]) << to_string(path) << test::name_of(technique);
      }
    }
  }
}

// A pigment that scatters forwards, against adding and doubling at twice its usual cosines, which is good to
// 1e-3 there. 2 techniques x 3 depths x 3 channels at 4.5 standard errors: 1.2e-4.
TEST(StatedErrors, HoldUnderAForwardPeak) {
  const Vec3 wi = spherical_direction(radians(60), 0), wo = spherical_direction(radians(40), radians(120));
  for (const double depth : {0.3, 1.0, 3.0}) {
    Material m;
    m.roughness = 0.2;
    m.absorption_per_nm = 0.25;
    m.scattering_per_nm = depth / m.pigment_thickness_nm;
    m.anisotropy = 0.9;
    SlabSolver solver(m, {wi.z, wo.z}, {.below = 24, .above = 40});
    solver.add_depth(m.optical_depth());
    const SlabSolver::Film film(solver, m.film_thickness_nm, Wavelengths::rgb3(m));
    const Rgb truth = film.rest(m.optical_depth()).at(1, 0, radians(120));
    const Pfmc pfmc(m);
    for (const Technique technique : test::kTechniques) {
      Rng rng(37, 0);
      const WalkedMean found = walked_mean(5000, [&] { return pfmc.estimate_rest(wo, wi, rng, technique); });
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found.value[c], truth[c], 4.5 * found.standard_error[c] + 1e-3 * truth[c]);
        EXPECT_LE(found.standard_error[c], 0.01 * truth[c]) << depth << test::name_of(technique);
      }
    }
  }
}

}  // namespace
}  // namespace sunbeam
