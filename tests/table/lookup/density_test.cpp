// The density of a bound table by quadrature: it integrates to what sample() returns of it.
#include "sunbeam/table_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/quadrature.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

// Both densities: of pdf() and of eval_pdf().
struct Densities {
  double pdf = 0, of_eval_pdf = 0;
};

Densities integrated(const TableBsdf& bsdf, const Vec3& wo) {
  Rng rng(1, 0);
  constexpr int kPolar = 250, kAzimuthal = 250;
  return {
      test::integrate_hemisphere(kPolar, kAzimuthal, [&](const Vec3& wi) { return bsdf.pdf(wo, wi, rng); }),
      test::integrate_hemisphere(kPolar, kAzimuthal,
                                 [&](const Vec3& wi) { return bsdf.eval_pdf(wo, wi).pdf; })};
}

// A smooth film loses no sample, and a Dirac one tells its chance: the mirror's weight over its throughput.
double chance_of_the_mirror(const TableBsdf& bsdf, const Vec3& wo) {
  Rng rng(2, 0);
  for (;;) {
    const auto sample = bsdf.sample(wo, rng);
    if (sample && sample->is_dirac) return bsdf.dirac(wo).g / sample->throughput.g;
  }
}

// Exact but for the quadrature.
TEST(Density, OfASmoothFilmAndItsMirrorIsOne) {
  for (const Table& table :
       {test::small_table(Precision::half_float, false), test::small_factored_table(0, AbsorptionPath::sum),
        test::small_factored_table(0, AbsorptionPath::product)}) {
    const TableBsdf bsdf(table, {260, 1.46, 0.1});
    for (const double theta : {0.1, 0.9, 1.4}) {
      const Vec3 wo = spherical_direction(theta, 1);
      const Densities found = integrated(bsdf, wo);
      const double left = 1 - chance_of_the_mirror(bsdf, wo);
      EXPECT_NEAR(found.pdf, left, 1e-5) << theta;
      EXPECT_NEAR(found.of_eval_pdf, left, 1e-5) << theta;
    }
  }
}

// A rough film loses some. 6 tables x 2 directions at 4.5 standard errors of 200000 draws, below 1e-3 each:
// false alarm 1e-4 in all.
TEST(Density, OfARoughFilmIsTheShareOfSamples) {
  for (const Table& table : {test::small_table(), test::small_anisotropic_table(),
                             test::small_factored_table(0.3, AbsorptionPath::sum),
                             test::small_factored_table(0.3, AbsorptionPath::product),
                             test::small_factored_table({0.3, 0.1}, AbsorptionPath::sum),
                             test::small_factored_table({0.3, 0.1}, AbsorptionPath::product)}) {
    const TableBsdf bsdf(table, {260, 1.46, 0.1});
    for (const double theta : {0.1, 0.9}) {
      const Vec3 wo = spherical_direction(theta, 1);
      const auto seen = test::sample_totals(bsdf, wo, 200000, 3).seen;
      const Densities found = integrated(bsdf, wo);
      const double most = 4.5 * seen.std_error() + 2e-4;
      EXPECT_LT(most, 4e-3);
      EXPECT_NEAR(found.pdf, seen.mean(), most) << theta;
      EXPECT_NEAR(found.of_eval_pdf, seen.mean(), most) << theta;
    }
  }
}

}  // namespace
}  // namespace sunbeam
