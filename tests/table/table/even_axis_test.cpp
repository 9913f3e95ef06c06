// Nodes of parameters in textured tables.
#include "runtime/src/base/even_axis.h"

#include <gtest/gtest.h>

namespace sunbeam {
namespace {

Axis base_ior(double from, double to, double exterior_ior) {
  return {"base_ior", "1", {from, to}, 2, 0, exterior_ior};
}

// Places are floats: a node is hit to 1e-5 of an interval, of 23 with a rounding of 6e-8 each.
TEST(EvenAxis, NodesLieAtTheirPlaces) {
  for (const Axis& axis : {base_ior(1, 2, 1), base_ior(1, 1.2, 1.33), base_ior(1, 2.5, 1.33),
                           base_ior(1.3, 2.5, 1.33), base_ior(1, 1.35, 1.33)}) {
    const EvenAxis even(axis, 24);
    EXPECT_EQ(even.node(0), axis.low());
    EXPECT_EQ(even.node(23), axis.high());
    for (int k = 0; k < 24; ++k) {
      const EvenPosition at = even.locate(even.node(k));
      EXPECT_NEAR(static_cast<double>(at.lower) + double{at.upper_weight}, k, 1e-5) << k;
      if (k > 0) {
        EXPECT_LT(even.node(k - 1), even.node(k)) << k;
      }
    }
  }
}

TEST(EvenAxis, TheExteriorIsANode) {
  const EvenAxis across(base_ior(1, 2.5, 1.33), 24);
  EXPECT_EQ(across.node(10), 1.33);  // 10 intervals below: 9 in 20 at least
  const EvenPosition at = across.locate(1.32999);
  EXPECT_EQ(at.lower, 9);
}

// Beyond the ends their nodes count.
TEST(EvenAxis, ClampsToItsEnds) {
  const EvenAxis across(base_ior(1, 2.5, 1.33), 24);
  EXPECT_EQ(across.clamped(0.5), 1);
  EXPECT_EQ(across.clamped(7), 2.5);
}

}  // namespace
}  // namespace sunbeam
