// The errors that estimators state hold for layered films too: 1 to 20 layers, clear and absorbing, with
// metals among and below them, dispersive and uneven.
#include <gtest/gtest.h>

#include "tests/support/estimator_sweep.h"
#include "tests/support/random_films.h"

namespace sunbeam {
namespace {

using test::SweepCase;

std::vector<SweepCase> draw_cases(int first, int count) {
  return test::draw_cases(41, first, count, [](Rng& rng, int number, Material& m) {
    return test::RandomFilms(rng).draw(number, m);
  });
}

// 200 materials. Two in three of the scores are independent, and tell the deviation to 0.03: one seed in a
// thousand fails.
TEST(LongLayeredStatedErrors, HoldForEveryPairOfEstimators) {
  test::expect_normal(test::compare_rests(draw_cases(0, 200), 3000), 900, 3, 0.1);
}

// The same for albedos by samples: to 0.035.
TEST(LongLayeredStatedErrors, HoldForAlbedos) {
  test::expect_normal(test::compare_albedos(draw_cases(0, 200), 20000), 300, 3, 0.1);
}

// The quick version over other materials; some sixty scores tell the deviation to 0.1.
TEST(LayeredStatedErrors, HoldForEveryPairOfEstimators) {
  test::expect_normal(test::compare_rests(draw_cases(200, 20), 1500), 50, 0, 0.3);
}

}  // namespace
}  // namespace sunbeam
