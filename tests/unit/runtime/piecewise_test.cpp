#include "sunbeam/detail/piecewise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sunbeam/core/rng.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

const std::vector<double> kWeights = {1, 0, 3, 4};  // sum 8: densities 4/8 times 1, 0, 3, 4

TEST(Piecewise, DensityAndIntegralByHand) {
  const PiecewiseConstant p(kWeights);
  EXPECT_EQ(p.size(), 4u);
  EXPECT_DOUBLE_EQ(p.integral(), 2);
  EXPECT_DOUBLE_EQ(p.pdf(0.1), 0.5);
  EXPECT_DOUBLE_EQ(p.pdf(0.3), 0);
  EXPECT_DOUBLE_EQ(p.pdf(0.6), 1.5);
  EXPECT_DOUBLE_EQ(p.pdf(0.99), 2);
}

// The cumulative distribution is 1/8, 1/8, 4/8, 1 at the bin ends.
TEST(Piecewise, SampleByHand) {
  const PiecewiseConstant p(kWeights);
  EXPECT_DOUBLE_EQ(p.sample(0), 0);
  EXPECT_DOUBLE_EQ(p.sample(1.0 / 16), 0.125);  // half of bin 0
  EXPECT_DOUBLE_EQ(p.sample(5.0 / 16), 0.625);  // half of bin 2
  EXPECT_DOUBLE_EQ(p.sample(3.0 / 4), 0.875);   // half of bin 3
  EXPECT_DOUBLE_EQ(p.sample(1.0 / 8), 0.5);     // jumps over the empty bin
  EXPECT_LT(p.sample(std::nextafter(1.0, 0.0)), 1);
}

TEST(Piecewise, SampleAndInvertAreInverse) {
  const PiecewiseConstant p(kWeights);
  Rng rng(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.uniform(), x = p.sample(u);
    EXPECT_NEAR(p.invert(x), u, 1e-14);
    EXPECT_GT(p.pdf(x), 0);
  }
}

TEST(Piecewise, DensityIsTheMapsJacobian) {
  const PiecewiseConstant p(kWeights);
  for (const double u : {0.05, 0.2, 0.4, 0.6, 0.9}) {
    const double slope = (p.sample(u + 1e-6) - p.sample(u - 1e-6)) / 2e-6;
    EXPECT_NEAR(slope * p.pdf(p.sample(u)), 1, 1e-9);
  }
}

TEST(Piecewise, AllZeroMeansUniform) {
  const PiecewiseConstant p(std::vector<double>{0, 0, 0});
  EXPECT_EQ(p.integral(), 0);
  for (const double x : {0.0, 0.2, 0.5, 0.9}) {
    EXPECT_DOUBLE_EQ(p.pdf(x), 1);
    EXPECT_NEAR(p.sample(x), x, 1e-15);
  }
}

TEST(Piecewise, NeverEntersEmptyBinsAtEitherEnd) {
  const PiecewiseConstant p(std::vector<double>{0, 1, 0});
  for (const double u : {0.0, 1e-300, 0.5, std::nextafter(1.0, 0.0)}) {
    EXPECT_GE(p.sample(u), 1.0 / 3) << u;
    EXPECT_LE(p.sample(u), 2.0 / 3) << u;
  }
}

// Weights of very different size keep a total of one.
TEST(Piecewise, ExtremeWeights) {
  const PiecewiseConstant p(std::vector<double>{1e-300, 1e300, 1e-300, 1});
  double total = 0;
  for (int i = 0; i < 4; ++i) total += p.pdf((i + 0.5) / 4) / 4;
  EXPECT_NEAR(total, 1, 1e-15);
  EXPECT_NEAR(p.pdf(0.3), 4, 1e-15);
}

}  // namespace
}  // namespace sunbeam
