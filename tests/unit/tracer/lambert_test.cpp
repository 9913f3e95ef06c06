#include "runtime/tracer/lambert.h"

#include <gtest/gtest.h>

#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

const Lambert kLambert(Rgb(0.2, 0.5, 0.8));
const Vec3 kWo = spherical_direction(1.1, 0.4), kBelow = spherical_direction(2.0, 0.4);

// Int albedo / pi cos = albedo, exactly what every sample carries.
TEST(Lambert, AlbedoBySampleAndByEval) {
  const auto sampled = test::sample_totals(kLambert, kWo, 1000, 1);
  EXPECT_EQ(sampled.empty, 0);
  EXPECT_EQ(sampled.dirac, 0);
  // Jittered midpoints on 100 x 100 cells: the error of Int cos is a few 1e-5.
  const auto integrated = test::albedo_by_eval(kLambert, kWo, 100, 2, 1);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(sampled.albedo[c].mean(), Rgb(0.2, 0.5, 0.8)[c], 1e-12);
    EXPECT_NEAR(integrated[c].mean(), Rgb(0.2, 0.5, 0.8)[c], 3e-4);
  }
  EXPECT_NEAR(test::integrate_pdf(kLambert, kWo, 100, 2, 1).mean(), 1, 3e-4);
}

TEST(Lambert, NothingBelowTheHorizon) {
  Rng rng(1, 0);
  EXPECT_TRUE(is_black(kLambert.eval(kWo, kBelow, rng)));
  EXPECT_TRUE(is_black(kLambert.eval(kBelow, kWo, rng)));
  EXPECT_EQ(kLambert.pdf(kWo, kBelow, rng), 0);
  EXPECT_EQ(kLambert.pdf(kBelow, kWo, rng), 0);
  EXPECT_FALSE(kLambert.sample(kBelow, rng));
}

TEST(Lambert, LeavesTheGeneratorUntouchedInEval) {
  Rng rng(1, 0), same(1, 0);
  kLambert.eval(kWo, kWo, rng);
  kLambert.pdf(kWo, kWo, rng);
  EXPECT_EQ(rng.next(), same.next());
}

}  // namespace
}  // namespace sunbeam
