// The yardsticks themselves: values from closed forms, and a wrong density must be caught.
#include "tests/support/stats.h"

#include <gtest/gtest.h>

#include "runtime/tracer/lambert.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam::test {
namespace {

// Two degrees of freedom: exp(-x / 2). One: erfc(sqrt(x / 2)). Four: exp(-x / 2) (1 + x / 2).
TEST(Stats, ChiSquareTailClosedForms) {
  for (const double x : {0.01, 0.5, 2.0, 7.0, 40.0, 300.0}) {
    EXPECT_NEAR(chi_square_tail(x, 2) / std::exp(-x / 2), 1, 1e-12);
    EXPECT_NEAR(chi_square_tail(x, 1) / std::erfc(std::sqrt(x / 2)), 1, 1e-11);
    EXPECT_NEAR(chi_square_tail(x, 4) / (std::exp(-x / 2) * (1 + x / 2)), 1, 1e-12);
  }
  EXPECT_EQ(chi_square_tail(0, 5), 1);
  EXPECT_NEAR(chi_square_tail(124.342, 100), 0.05, 1e-6);  // the table's 5 % point
}

TEST(Stats, RunningMeanByHand) {
  RunningMean m;
  for (const double x : {1.0, 2.0, 3.0, 6.0}) m.add(x);
  EXPECT_DOUBLE_EQ(m.mean(), 3);
  EXPECT_DOUBLE_EQ(m.variance(), 14.0 / 3);  // (4 + 1 + 0 + 9) / 3
  EXPECT_DOUBLE_EQ(m.std_error(), std::sqrt(14.0 / 12));
}

TEST(Stats, SidakInvertsTheProductOfLevels) {
  EXPECT_DOUBLE_EQ(sidak(0.01, 1), 0.01);
  EXPECT_NEAR(1 - std::pow(1 - sidak(0.05, 20), 20), 0.05, 1e-14);
}

TEST(Stats, ThinCellsArePooled) {
  const auto result = chi_square({{100, 100}, {120, 100}, {4, 3}, {6, 5}, {5, 4}});
  EXPECT_EQ(result.degrees, 3);
  EXPECT_DOUBLE_EQ(result.statistic, 4 + 9.0 / 12);  // 20^2/100, then 15 against 12
  EXPECT_EQ(chi_square({{100, 100}, {50, 0}}).p_value, 0);
}

// A density 5 % off in its shape, and a sampler with the right one.
class Skewed final : public Bsdf {
 public:
  Rgb eval(const Vec3&, const Vec3&, Rng&) const override { return Rgb(kInvPi); }
  std::optional<BsdfSample> sample(const Vec3&, Rng& rng) const override {
    return BsdfSample{sample_cosine({rng.uniform(), rng.uniform()}), Rgb(1), false, 0};
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
  double mis_pdf(const Vec3&, const Vec3& wi) const override {
    return cosine_pdf(wi.z) * (1 + 0.05 * (2 * wi.z * wi.z - 1));  // still integrates to 1
  }
};

TEST(Stats, ChiSquareTellsRightFromWrong) {
  const Vec3 wo = spherical_direction(0.5, 0);
  const ChiSquareOptions options{.pdf_samples = 2};
  EXPECT_GT(chi_square_of_sampling(Lambert(Rgb(0.5)), wo, options, 1).p_value, 1e-4);
  EXPECT_LT(chi_square_of_sampling(Skewed(), wo, options, 1).p_value, 1e-9);
}

}  // namespace
}  // namespace sunbeam::test
