// The closed forms that give stored factored tables their meaning, against numbers worked out by hand.
#include "sunbeam/detail/factors.h"

#include <gtest/gtest.h>

namespace sunbeam {
namespace {

// Water over a film of 1.56 on a base of 1.5.
Material in_water(const Roughness& roughness) {
  Material m;
  m.exterior_ior = 1.33;
  m.film_ior = 1.56;
  m.base_ior = 1.5;
  m.roughness = roughness;
  return m;
}

constexpr double kBelow = 0.7048731958;  // sqrt(1 - (0.8 * 1.33 / 1.5)^2)

TEST(Factors, FringeOrderIsThePathInTheFilm) {
  const Material m = in_water(0.1);
  EXPECT_NEAR(fringe_order(m, 1), 3.12, 1e-12);           // 2 * 1.56
  EXPECT_NEAR(fringe_order(m, 0.6), 2.2816695642, 1e-9);  // 2 sqrt(1.56^2 - (0.8 * 1.33)^2)
  Material thin = m;
  thin.film_ior = 1.1;  // no cosine at grazing: 0.2 is kept
  EXPECT_NEAR(fringe_order(thin, 0.1), 0.44, 1e-12);
}

TEST(Factors, ArrivalCosineIsBlurredByThreeTenthsOfTheRoughness) {
  EXPECT_NEAR(arrival_cosine(in_water(0), 0.6), kBelow, 1e-9);
  EXPECT_NEAR(arrival_cosine(in_water(0.4), 0.6), std::sqrt(kBelow * kBelow + 0.0144), 1e-9);
  EXPECT_NEAR(arrival_cosine(in_water({0.1, 0.4}), 0.6), std::sqrt(kBelow * kBelow + 0.0144), 1e-9);
  Material straight = in_water(0.4);
  straight.transmission = Transmission::straight;
  EXPECT_EQ(arrival_cosine(straight, 0.6), 0.6);
}

// It bends where arrival_cosine() breaks off: at the critical cosine c* = 0.6 of a base of 0.8 times the
// exterior's index.
TEST(Factors, CrossingCosineHasNoKnee) {
  EXPECT_EQ(crossing_cosine(in_water(0.4), 0.6), arrival_cosine(in_water(0.4), 0.6));
  Material rare = in_water(0.1);
  rare.base_ior = 0.8 * 1.33;
  EXPECT_NEAR(crossing_cosine(rare, 0.6), std::sqrt(0.06 + 0.0009), 1e-9);  // c* 0.1 + (0.3 0.1)^2
  EXPECT_NEAR(crossing_cosine(rare, 1), std::sqrt((1 + std::hypot(1, 0.12)) / 2 + 0.0009), 1e-9);
  EXPECT_NEAR(crossing_cosine(rare, 0), std::sqrt((-0.5625 + std::hypot(0.5625, 0.12)) / 2 + 0.0009), 1e-9);
  rare.base_ior = 1.33 - 1e-9;  // equal media
  EXPECT_NEAR(crossing_cosine(rare, 0.3), arrival_cosine(rare, 0.3), 1e-5);
  EXPECT_EQ(crossing_cosine(in_water(0), 0.6), arrival_cosine(in_water(0), 0.6));
}

TEST(Factors, OneVisitOfAProduct) {
  EXPECT_NEAR(one_visit_of_product(0.5, 0.5, 0.25), std::exp(0.5 * (2 + 4 - 8)), 1e-12);
  EXPECT_NEAR(one_visit_of_product(0.5, 1, 0.25), std::exp(0.5), 1e-12);
}

}  // namespace
}  // namespace sunbeam
