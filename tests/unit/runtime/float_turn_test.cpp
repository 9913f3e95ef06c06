// Azimuths in single floats.
#include "runtime/src/sampling/float_turn.h"

#include <gtest/gtest.h>

#include "runtime/src/sampling/facets.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

TEST(FloatTurn, IsCosineAndSine) {
  for (std::uint32_t step = 0; step < FloatTurn::kSteps; ++step)
    for (const float inside : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}) {
      const FloatTurn turn(step, inside);
      const double angle = 2 * kPi * (step + double{inside}) / FloatTurn::kSteps;
      EXPECT_NEAR(turn.cosine, std::cos(angle), 2e-7) << step << ' ' << inside;
      EXPECT_NEAR(turn.sine, std::sin(angle), 2e-7) << step << ' ' << inside;
    }
}

// The floats' error does not reach the length.
TEST(FloatTurn, DirectionsAreUnitVectors) {
  Rng rng(1, 0);
  for (int k = 0; k < 1000; ++k)
    EXPECT_NEAR(length(at_azimuth(rng.uniform(), FloatTurn(rng.uniform()))), 1, 1e-13);
}

}  // namespace
}  // namespace sunbeam
