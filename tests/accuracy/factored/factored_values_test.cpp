// Factored tables against live walks, which know nothing of factors.
#include "bake/live/pfmc.h"
#include "tests/accuracy/factored/support.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

using test::FactoredTable;

// Parameters between the nodes, and directions in and out of the grooves' planes.
const Parameters kParameters[] = {{433, 1.15, 0.21}, {1111, 1.02, 0.03}};
const Vec3 kDirections[] = {spherical_direction(0.2, 0.3), spherical_direction(0.8, 2.1),
                            spherical_direction(1.2, 4.4)};

// 14 rows x 2 parameters x 3 wi x 3 wo x 3 channels: |z| < 5.5 by Bonferroni (4e-8 each) is a false alarm of
// 3e-5 in all if means were normal. Half a percent, the p99 of the tables themselves, is forgiven.
TEST_P(FactoredTable, AgreesWithWalks) {
  constexpr int kBatches = 32, kEstimates = 128;
  const Recipe recipe = test::recipe_of(GetParam(), "full");
  for (const Parameters& parameters : kParameters) {
    const TableBsdf bsdf(table(), parameters);
    const Pfmc model(bsdf.material(), recipe.spectrum.wavelengths(bsdf.material()));
    for (const Vec3& wi : kDirections) {
      test::RgbMean live[3];
      Rng rng(5, 0);
      for (int b = 0; b < kBatches; ++b) {
        Rgb sums[3];
        for (int k = 0; k < kEstimates; ++k) model.add_rest(wi, kDirections, rng, sums);
        for (int o = 0; o < 3; ++o) live[o].add(sums[o] / kEstimates);
      }
      for (int o = 0; o < 3; ++o) {
        const Rgb value = bsdf.rest(kDirections[o], wi);
        EXPECT_LT(live[o].grey.std_error(), 0.015 * mean(value)) << wi.z << ' ' << o;
        for (int c = 0; c < 3; ++c)
          EXPECT_LT(
              test::deviation(value[c], live[o][c].std_error(), live[o][c].mean(), 0, 5e-3 * mean(value)),
              5.5)
              << parameters.film_thickness_nm << ' ' << wi.z << ' ' << kDirections[o].z << " channel " << c
              << ": table " << value[c] << ", live " << live[o][c].mean() << " +- " << live[o][c].std_error();
      }
    }
  }
}

}  // namespace
}  // namespace sunbeam
