// The noise of replicates by hand.
#include "bake/factored/replicates.h"

#include <gtest/gtest.h>

namespace sunbeam {
namespace {

// 1, 2, 3, 6: mean 3, sum of squared deviations 14; the variance of the mean is 14 / 3 / 4.
TEST(Replicates, MeanAndTheVarianceOfTheMean) {
  Replicates replicates(2);
  for (const double x : {1.0, 2.0, 3.0, 6.0}) replicates.add({x, 5});
  EXPECT_DOUBLE_EQ(replicates.mean()[0], 3);
  EXPECT_NEAR(replicates.variance(0), 14.0 / 12, 1e-12);
  EXPECT_DOUBLE_EQ(replicates.mean()[1], 5);
  EXPECT_NEAR(replicates.variance(1), 0, 1e-12);
}

}  // namespace
}  // namespace sunbeam
