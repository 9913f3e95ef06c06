// eval, sample, pdf and albedo of a baked table agree with each other: all of them are deterministic but
// sample, so that 0.1 % is a matter of quadrature and of a million samples.
#include "tests/accuracy/support.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

using TableConsistency = test::EachConfiguration;

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const Vec3 kSteep = spherical_direction(0.3, 2.5);
const Vec3 kGrazing = spherical_direction(1.4, 5);

// 12 configurations x 3 directions, false alarm 1e-3 in all.
TEST_P(TableConsistency, SamplesFollowThePdf) {
  const TableBsdf bsdf = test::bsdf_of(table());
  for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
    const auto result = test::chi_square_of_sampling(bsdf, wo, {.samples = 100000, .pdf_samples = 16}, 1);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 36)) << wo.z;
    EXPECT_GT(result.degrees, 100) << wo.z;
  }
}

// Albedo three ways, the Dirac apart. Standard errors of sampling are below 0.03 % (asserted), so that 0.1 %
// is more than 3 of them: false alarm below 12 x 2 x 1e-3 with another seed.
TEST_P(TableConsistency, AlbedoWithinOnePerMille) {
  const TableBsdf bsdf = test::bsdf_of(table());
  for (const Vec3& wo : {kOblique, kSteep}) {
    const double by_quadrature = mean(bsdf.albedo(wo)), dirac = mean(bsdf.dirac(wo));
    const auto by_eval_rgb = test::albedo_by_eval(bsdf, wo, 300, 8, 2);
    const auto& by_eval = by_eval_rgb.grey;
    EXPECT_LT(by_eval.std_error(), 2e-4 * by_eval.mean()) << wo.z;
    EXPECT_NEAR(by_eval.mean() + dirac, by_quadrature, 1e-3 * by_quadrature) << wo.z;
    const auto sampled = test::sample_totals(bsdf, wo, 1000000, 2);
    const auto& by_sample = sampled.albedo.grey;
    EXPECT_LT(by_sample.std_error(), 3e-4 * by_sample.mean()) << wo.z;
    EXPECT_NEAR(by_sample.mean(), by_eval.mean() + dirac, 1e-3 * by_sample.mean()) << wo.z;
    EXPECT_NEAR(by_sample.mean(), by_quadrature, 1e-3 * by_quadrature) << wo.z;
    // Without the Dirac, channel by channel at their own noise.
    for (int c = 0; c < 3; ++c) {
      const auto& rest = sampled.non_dirac_albedo[c];
      EXPECT_LT(test::deviation(rest.mean(), rest.std_error(), by_eval_rgb[c].mean(),
                                by_eval_rgb[c].std_error(), 1e-3 * rest.mean()),
                4.5)
          << wo.z << " channel " << c;
    }
  }
}

// Int pdf + P(Dirac) + P(empty) = 1. The frequencies' standard error is at most 0.5 / sqrt(500000) = 7e-4;
// 4.5 standard errors of the difference: false alarm 12 x 3 x 7e-6 in all. Seen at grazing the lobe is 0.03
// rad narrow, which takes a finer grid.
TEST_P(TableConsistency, ProbabilitiesAddUpToOne) {
  const TableBsdf bsdf = test::bsdf_of(table());
  for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
    const auto totals = test::sample_totals(bsdf, wo, 500000, 3);
    const auto integral = test::integrate_pdf(bsdf, wo, wo.z < 0.2 ? 800 : 200, 4, 3);
    EXPECT_LT(integral.std_error(), 1e-3) << wo.z;
    EXPECT_LT(
        test::deviation(totals.seen.mean(), totals.seen.std_error(), integral.mean(), integral.std_error()),
        4.5)
        << wo.z;
  }
}

// A table is symmetric to the last bit; eval multiplies in another order.
TEST_P(TableConsistency, Reciprocal) {
  const TableBsdf bsdf = test::bsdf_of(table());
  Rng rng(4, 0);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 a = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Vec3 b = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Rgb ab = bsdf.eval(a, b, rng), ba = bsdf.eval(b, a, rng);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(ab[c], ba[c], 1e-6 * ab[c] + 1e-15) << a.z << ' ' << b.z;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, TableConsistency, ::testing::ValuesIn(test::configurations()),
                         test::configuration_name);

}  // namespace
}  // namespace sunbeam
