#include "runtime/tracer/gloss.h"

#include <gtest/gtest.h>

#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

const Gloss kRough(1.5, 0.4);
const Vec3 kWo = spherical_direction(1.1, 0.4), kBelow = spherical_direction(2.0, 0.4);

TEST(Gloss, SampleEvalAndPdfAgree) {
  const auto sampled = test::sample_totals(kRough, kWo, 40000, 1);
  const auto integrated = test::albedo_by_eval(kRough, kWo, 100, 16, 1);
  const auto density = test::integrate_pdf(kRough, kWo, 100, 16, 1);
  // 4.5 standard errors: a false alarm in 150000 seeds each.
  EXPECT_LT(test::deviation(sampled.albedo.grey.mean(), sampled.albedo.grey.std_error(),
                            integrated.grey.mean(), integrated.grey.std_error()),
            4.5);
  EXPECT_LT(
      test::deviation(sampled.seen.mean(), sampled.seen.std_error(), density.mean(), density.std_error()),
      4.5);
  EXPECT_GT(sampled.empty, 0.001);  // else mirrored directions below the horizon were not tried
}

// Nearly smooth, what comes back is the Fresnel reflectance; the reference is in the angles of Snell's law.
TEST(Gloss, ReflectsByFresnel) {
  const double ior = 1.33;
  const Gloss smooth(ior, 1e-3);
  EXPECT_NEAR(test::sample_totals(smooth, {0, 0, 1}, 100, 1).albedo.grey.mean(), square(0.33 / 2.33), 1e-6);
  for (const double angle : {0.3, 0.9, 1.4}) {
    const double inside = std::asin(std::sin(angle) / ior);
    const double s = std::sin(angle - inside) / std::sin(angle + inside),
                 p = std::tan(angle - inside) / std::tan(angle + inside);
    EXPECT_NEAR(test::sample_totals(smooth, spherical_direction(angle, 1), 1000, 1).albedo.grey.mean(),
                0.5 * (s * s + p * p), 2e-3)
        << angle;
  }
}

TEST(Gloss, IsReciprocalAndBlackBelowTheHorizon) {
  Rng rng(1, 0);
  const Vec3 wi = spherical_direction(0.7, 3);
  EXPECT_NEAR(kRough.eval(kWo, wi, rng).r, kRough.eval(wi, kWo, rng).r, 1e-14);
  EXPECT_TRUE(is_black(kRough.eval(kWo, kBelow, rng)));
  EXPECT_TRUE(is_black(kRough.eval(kBelow, kWo, rng)));
  EXPECT_EQ(kRough.mis_pdf(kWo, kBelow), 0);
  EXPECT_FALSE(kRough.sample(kBelow, rng));
}

}  // namespace
}  // namespace sunbeam
