#include "sunbeam/detail/axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace sunbeam {
namespace {

using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Axis plain(std::vector<double> nodes, double power = 1, double period = 0, double origin = 0) {
  return {"x", "1", std::move(nodes), power, period, origin};
}

// What the bracket stands for: the interpolated axis coordinate, whichever end a node is attributed to.
double located_coordinate(const Axis& axis, double x) {
  const Bracket at = axis.locate(x);
  const double u0 = axis.coordinate(axis.nodes[at.lower]), u1 = axis.coordinate(axis.nodes[at.upper]);
  return (1 - at.upper_weight) * u0 + at.upper_weight * u1;
}

TEST(Axis, BetweenNodes) {
  const Axis axis = plain({1, 2, 4});
  const Bracket at = axis.locate(2.5);
  EXPECT_EQ(at.lower, 1u);
  EXPECT_EQ(at.upper, 2u);
  EXPECT_DOUBLE_EQ(at.upper_weight, 0.25);  // (2.5 - 2) / (4 - 2)
}

TEST(Axis, NodesAreHitExactlyWhateverThePower) {
  for (const double power : {1.0, 2.0, 3.0, 2.5}) {
    const Axis axis = plain({0.5, 0.7, 1.3, 2}, power);
    for (std::size_t k = 0; k < axis.size(); ++k) {
      const Bracket at = axis.locate(axis.nodes[k]);
      EXPECT_TRUE((at.lower == k && at.upper_weight == 0) || (at.upper == k && at.upper_weight == 1))
          << "power " << power << " node " << k << ": " << at.lower << ' ' << at.upper_weight;
    }
  }
}

TEST(Axis, OutsideIsTheNearestNode) {
  for (const double power : {1.0, 2.0, 3.0}) {
    const Axis axis = plain({1, 2, 4}, power);
    EXPECT_EQ(located_coordinate(axis, -7), axis.coordinate(1));
    EXPECT_EQ(located_coordinate(axis, 1e9), axis.coordinate(4));
  }
}

TEST(Axis, OneNodeTakesEverything) {
  for (const Axis& axis : {plain({3}), plain({0}, 1, 2 * kPi)})
    for (const double x : {-1.0, 3.0, 100.0}) {
      const Bracket at = axis.locate(x);
      EXPECT_EQ(at.lower, 0u);
      EXPECT_EQ(at.upper, 0u);
      EXPECT_EQ(at.upper_weight, 0);
    }
}

// Linear in u = (x - origin)^(1/power). With origin 1 and nodes 1, 2, 9, that is offsets 0, 1, 8:
//   power 2: u = 0, 1, sqrt 8; x = 5 has u = 2, weight (2 - 1) / (sqrt 8 - 1)
//   power 3: u = 0, 1, 2;      x = 1 + 1.5^3 has u = 1.5, weight 1/2
TEST(Axis, WarpedPowers) {
  const Bracket square_root = plain({1, 2, 9}, 2, 0, 1).locate(5);
  EXPECT_EQ(square_root.lower, 1u);
  EXPECT_NEAR(square_root.upper_weight, 1 / (std::sqrt(8.0) - 1), 1e-15);
  const Bracket cube_root = plain({1, 2, 9}, 3, 0, 1).locate(1 + 1.5 * 1.5 * 1.5);
  EXPECT_EQ(cube_root.lower, 1u);
  EXPECT_NEAR(cube_root.upper_weight, 0.5, 1e-15);
  EXPECT_NEAR(plain({1, 17}, 4, 0, 1).locate(2).upper_weight, 0.5, 1e-15);  // u = 0, 2; x = 2 has u = 1
}

// The origin need not be a node: nodes 1, 4 of power 2 from 0 have u = 1, 2; x = 2.25 has u = 1.5.
TEST(Axis, OriginBelowTheNodes) {
  EXPECT_NEAR(plain({1, 4}, 2).locate(2.25).upper_weight, 0.5, 1e-15);
  EXPECT_NEAR(plain({-3, 4}, 1, 0, 7).locate(0.5).upper_weight, 0.5, 1e-15);  // power 1 has no use for it
}

// Nodes at 0, 90, 180, 270 degrees; 315 degrees lies half-way between the last node and the first.
TEST(Axis, PeriodicWrapsAcrossTheSeam) {
  const Axis axis = plain({0, kPi / 2, kPi, 3 * kPi / 2}, 1, 2 * kPi);
  EXPECT_DOUBLE_EQ(axis.high(), 2 * kPi);
  for (const int turns : {-3, -1, 0, 1, 2}) {
    const Bracket seam = axis.locate(7 * kPi / 4 + 2 * kPi * turns);
    EXPECT_EQ(seam.lower, 3u) << turns;
    EXPECT_EQ(seam.upper, 0u) << turns;
    EXPECT_NEAR(seam.upper_weight, 0.5, 1e-14) << turns;
    const Bracket inside = axis.locate(kPi / 8 + 2 * kPi * turns);
    EXPECT_EQ(inside.lower, 0u) << turns;
    EXPECT_EQ(inside.upper, 1u) << turns;
    EXPECT_NEAR(inside.upper_weight, 0.25, 1e-14) << turns;
  }
}

// On both sides of the seam the weight of node 0 tends to 1: rounding may put x on either.
TEST(Axis, PeriodicIsContinuousAtTheSeam) {
  const Axis axis = plain({0, 1, 3}, 1, 2 * kPi);
  for (const double x : {0.0, -1e-15, -1e-300, 2 * kPi, 2 * kPi - 1e-15, -2 * kPi}) {
    const Bracket at = axis.locate(x);
    const double weight_of_first =
        (at.lower == 0 ? 1 - at.upper_weight : 0) + (at.upper == 0 ? at.upper_weight : 0);
    EXPECT_NEAR(weight_of_first, 1, 1e-14) << x;
    EXPECT_GE(at.upper_weight, 0) << x;
    EXPECT_LE(at.upper_weight, 1) << x;
  }
}

// A first node other than 0: [1, 1 + 2 pi).
TEST(Axis, PeriodicWithOffset) {
  const Axis axis = plain({1, 3}, 1, 2 * kPi);
  EXPECT_NEAR(axis.locate(2 + 2 * kPi).upper_weight, 0.5, 1e-14);
  const Bracket seam = axis.locate(0);  // 2 pi - 3 beyond the last node, of a gap of 2 pi - 2
  EXPECT_EQ(seam.lower, 1u);
  EXPECT_EQ(seam.upper, 0u);
  EXPECT_NEAR(seam.upper_weight, (2 * kPi - 3) / (2 * kPi - 2), 1e-14);
}

TEST(Axis, DefectsAreNamed) {
  EXPECT_EQ(plain({1}).defect(), "");
  EXPECT_EQ(plain({-1, 0, 5}, 3, 0, -1).defect(), "");
  EXPECT_EQ(plain({0, 6.2}, 1, 2 * kPi).defect(), "");
  EXPECT_THAT(plain({}).defect(), HasSubstr("no nodes"));
  EXPECT_THAT(plain({1, 1}).defect(), HasSubstr("do not increase"));
  EXPECT_THAT(plain({2, 1}).defect(), HasSubstr("do not increase"));
  EXPECT_THAT(plain({kNan}).defect(), HasSubstr("not finite"));
  EXPECT_THAT(plain({0, kInf}).defect(), HasSubstr("not finite"));
  for (const double power : {0.0, 0.5, -1.0, 9.0, kNan})
    EXPECT_THAT(plain({0, 1}, power).defect(), HasSubstr("power")) << power;
  for (const double period : {-1.0, kNan, kInf})
    EXPECT_THAT(plain({0, 1}, 1, period).defect(), HasSubstr("bad period")) << period;
  EXPECT_THAT(plain({0, 2 * kPi}, 1, 2 * kPi).defect(), HasSubstr("beyond its period"));
  // The coordinates of nodes that differ may be the same, or so near that floats are.
  EXPECT_THAT(plain({1e18, 1e18 + 200, 2e18}, 2).defect(), HasSubstr("coincide"));
  EXPECT_THAT(plain({0, 1}, 2, 0, -1e30).defect(), HasSubstr("coincide"));
  EXPECT_THAT(plain({0, 1e-8, 1}).defect(), HasSubstr("coincide"));
  EXPECT_THAT(plain({0, 2 * kPi - 1e-9}, 1, 2 * kPi).defect(), HasSubstr("coincide"));
  EXPECT_EQ(plain({0, 1e-5, 1}).defect(), "");
  EXPECT_EQ(plain({0, 1e-12, 1}, 3).defect(), "");
  EXPECT_THAT(plain({1, 2}, 2, 0, 1.5).defect(), HasSubstr("between two nodes"));
  EXPECT_EQ(plain({1, 1.5, 2}, 2, 0, 1.5).defect(), "");
  EXPECT_EQ(plain({1, 2}, 2, 0, 3).defect(), "");
  Axis soft = plain({1, 2}, 2, 0, 1.5);
  soft.softness = 0.1;
  EXPECT_EQ(soft.defect(), "");
  for (const double softness : {-0.1, kNan, kInf}) {
    soft.softness = softness;
    EXPECT_THAT(soft.defect(), HasSubstr("bad softness")) << softness;
  }
  soft.softness = 0.1;
  soft.power = 3;
  EXPECT_THAT(soft.defect(), HasSubstr("bad softness"));
  for (const double origin : {kNan, kInf})
    EXPECT_THAT(plain({1, 2}, 2, 0, origin).defect(), HasSubstr("origin")) << origin;
}

// Uniform in u: with power 2 and origin 1 the offsets are 3 (k/3)^2; from 4 to 16 with origin 0, u = 2, 3, 4.
TEST(Axis, SpacedNodesAreUniformInTheCoordinate) {
  const auto nodes = spaced_nodes(1, 4, 4, 2, 1);
  ASSERT_EQ(nodes.size(), 4u);
  EXPECT_EQ(nodes.front(), 1);
  EXPECT_NEAR(nodes[1], 1 + 3.0 / 9, 1e-14);
  EXPECT_NEAR(nodes[2], 1 + 12.0 / 9, 1e-14);
  EXPECT_EQ(nodes.back(), 4);
  const auto above = spaced_nodes(4, 16, 3, 2);
  EXPECT_EQ(above.front(), 4);
  EXPECT_NEAR(above[1], 9, 1e-14);
  EXPECT_EQ(above.back(), 16);
  EXPECT_EQ(spaced_nodes(5, 5, 1, 3), std::vector<double>{5});
  const auto linear = spaced_nodes(-2, 2, 5);
  EXPECT_EQ(linear, (std::vector<double>{-2, -1, 0, 1, 2}));
}

// u = -sqrt(1 - x) below 1 and sqrt(x - 1) above: -1/2 of it is x = 3/4. Below get at least 9 of 20.
TEST(Axis, SpacedNodesAcrossAKinkAreUniformOnEitherSide) {
  const Axis axis = plain({}, 2, 0, 1);
  EXPECT_EQ(spaced_nodes(axis, 0, 5, 5), (std::vector<double>{0, 1, 1 + 4.0 / 9, 1 + 16.0 / 9, 5}));
  EXPECT_EQ(spaced_nodes(axis, 0, 2, 5), (std::vector<double>{0, 0.75, 1, 1.25, 2}));
  EXPECT_EQ(spaced_nodes(axis, 0, 1, 3), (std::vector<double>{0, 0.75, 1}));
  EXPECT_EQ(intervals_below(19, 1, 1000), 8u);
  EXPECT_EQ(intervals_below(19, 1, 1), 10u);
  EXPECT_EQ(intervals_below(19, 1000, 1), 18u);
  EXPECT_EQ(intervals_below(2, 1, 1000), 1u);
}

// With softness a, y = x - origin is (u^2 + |u| sqrt(u^2 + 4 a)) / 2 with the sign of u. Rounding: 1e-15
// of 4.
TEST(Axis, CoordinatesHaveInverses) {
  Axis soft = plain({}, 2, 0, 0.3);
  soft.softness = 0.1;
  EXPECT_NEAR(soft.coordinate(0.7), 0.4 / std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(soft.coordinate(-0.1), -0.4 / std::sqrt(0.5), 1e-15);
  for (const Axis& axis :
       {soft, plain({}, 1, 0, 0.3), plain({}, 2, 0, 0.3), plain({}, 3, 0, 0.3), plain({}, 2.5, 0, 0.3)})
    for (const double x : {-4.0, -0.1, 0.29, 0.3, 0.31, 1.0, 4.0})
      EXPECT_NEAR(axis.at_coordinate(axis.coordinate(x)), x, 1e-14) << axis.power << ' ' << axis.softness;
}

}  // namespace
}  // namespace sunbeam
