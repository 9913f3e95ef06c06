// At its own nodes a table is the live model up to noise that it states itself.
#include "bake/live/pfmc.h"
#include "tests/accuracy/support.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

using Nodes = test::EachConfiguration;

// Per configuration 36 direction pairs (8 x 8, reciprocal ones are one value), mean over channels, against an
// independent live run of 4000 walks. All z-scores by Bonferroni, which needs no independence: 12 x 36 of
// them, false alarm 1e-3 in all if they were normal, so |z| < 4.8; 6 leaves room for the tails of the walks.
// The root mean square of z is 1 if rest_stderr is right. A row of the table shares its walks, so that its z
// are nearly one: chi-square of 8 degrees over 8 exceeds 1.9^2 in 3e-4 and falls below 0.3^2 in 1e-5 of
// cases.
TEST_P(Nodes, AgreeWithTheLiveModel) {
  constexpr int kWalks = 4000;
  const TableBsdf bsdf = test::bsdf_of(table());
  const Pfmc model(table().material);
  const auto cosines = table().remainder.axes()[3].nodes;
  test::RunningMean square_of_z;
  for (std::size_t i = 0; i < cosines.size(); ++i)
    for (std::size_t o = i; o < cosines.size(); ++o) {
      const Vec3 wi = direction_from_cosine(cosines[i], 0), wo = direction_from_cosine(cosines[o], 0);
      Rng rng(77, i * cosines.size() + o);
      test::RunningMean live;
      for (int k = 0; k < kWalks; ++k) live.add(mean(model.estimate_rest(wo, wi, rng)));
      const double stored = mean(bsdf.rest(wo, wi)), error = bsdf.rest_stderr(wo, wi).g;
      // Single precision of the array; the smooth film's first visit is exact, so that both errors can be
      // tiny.
      const double slack = 2e-7 * stored + 1e-12;
      const double difference = std::max(0.0, std::abs(stored - live.mean()) - slack);
      const double z = difference == 0 ? 0 : difference / std::hypot(error, live.std_error());
      EXPECT_LT(z, 6) << "cosines " << cosines[i] << ' ' << cosines[o] << ": table " << stored << " +- "
                      << error << ", live " << live.mean() << " +- " << live.std_error();
      if (stored > 1e-6) square_of_z.add(z * z);
    }
  EXPECT_GT(square_of_z.count(), 24);  // the rest is too dark in some
  EXPECT_GT(std::sqrt(square_of_z.mean()), 0.3);
  EXPECT_LT(std::sqrt(square_of_z.mean()), 1.9);
}

// The recipe's noise is the mean over channels of the standard error, relative to the value; averaging with
// the reciprocal value only lowers it. (The cap on walks is far away at 1 %.)
TEST_P(Nodes, AreAsExactAsTheRecipeAsks) {
  const TableBsdf bsdf = test::bsdf_of(table());
  const double noise = GetParam().recipe.noise, darkest = 0.002 * kInvPi;
  for (const double i : table().remainder.axes()[3].nodes)
    for (const double o : table().remainder.axes()[5].nodes) {
      const Vec3 wi = direction_from_cosine(i, 0), wo = direction_from_cosine(o, 0);
      const double error = mean(bsdf.rest_stderr(wo, wi));
      // Two rows may stop at different values: 2 % of them, generously.
      EXPECT_LE(error, 1.02 * noise * std::max(mean(bsdf.rest(wo, wi)), darkest)) << i << ' ' << o;
    }
}

INSTANTIATE_TEST_SUITE_P(Each, Nodes, ::testing::ValuesIn(test::configurations()), test::configuration_name);

}  // namespace
}  // namespace sunbeam
