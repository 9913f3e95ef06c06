// Cubic interpolation along one axis: which nodes a value is made of, and what it reproduces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "runtime/src/base/bound_axis.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/axis.h"

namespace sunbeam {
namespace {

using ::testing::HasSubstr;

Axis cubic(std::vector<double> nodes, double power = 1) {
  const double origin = nodes.front();
  return {"x", "1", std::move(nodes), power, 0, origin, true};
}

// What a stencil makes of node values that follow `f` of the axis coordinate.
double interpolated(const Axis& axis, double x, const std::function<double(double)>& f) {
  const Stencil at = axis.stencil(x);
  double sum = 0;
  for (std::size_t k = 0; k < at.count; ++k) sum += at.weight[k] * f(axis.coordinate(axis.nodes[at.node[k]]));
  return sum;
}

double weights_of(const Stencil& at) {
  double sum = 0;
  for (std::size_t k = 0; k < at.count; ++k) sum += at.weight[k];
  return sum;
}

const std::vector<double> kUneven = {0.5, 0.7, 1.3, 2, 2.1, 4};

// Four nodes hold any cubic of the coordinate. Rounding: uneven nodes give weights up to 60 here, so that
// 60 x 4 x 2^-53 x the largest value of 100 stays below 1e-11.
TEST(AxisStencil, CubicsOfTheCoordinateAreExact) {
  const auto cube = [](double u) { return 1 - 2 * u + 3 * u * u - 1.5 * u * u * u; };
  Rng rng(1, 0);
  for (const double power : {1.0, 2.0, 3.0, 2.5}) {
    const Axis axis = cubic(kUneven, power);
    for (int k = 0; k < 1000; ++k) {
      const double x = std::lerp(axis.low(), axis.high(), rng.uniform());
      EXPECT_NEAR(interpolated(axis, x, cube), cube(axis.coordinate(x)), 1e-11) << power << ' ' << x;
      EXPECT_NEAR(weights_of(axis.stencil(x)), 1, 1e-13);
    }
  }
}

// Two on either side where there are as many, else the four at the end.
TEST(AxisStencil, TheFourNearestNodes) {
  const Axis axis = cubic({0, 1, 2, 3, 4, 5});
  const auto first_at = [&](double x) {
    const Stencil at = axis.stencil(x);
    EXPECT_EQ(at.count, 4u) << x;
    for (std::size_t k = 1; k < 4; ++k) EXPECT_EQ(at.node[k], at.node[0] + k) << x;
    return at.node[0];
  };
  EXPECT_EQ(first_at(0.5), 0u);
  EXPECT_EQ(first_at(1.5), 0u);
  EXPECT_EQ(first_at(2.5), 1u);
  EXPECT_EQ(first_at(3.5), 2u);
  EXPECT_EQ(first_at(4.5), 2u);
}

// Half-way between even nodes Lagrange's weights are (-1, 9, 9, -1) / 16.
TEST(AxisStencil, WeightsByHand) {
  const Stencil at = cubic({0, 1, 2, 3}).stencil(1.5);
  EXPECT_EQ(at.weight, (std::array{-1.0 / 16, 9.0 / 16, 9.0 / 16, -1.0 / 16}));
}

TEST(AxisStencil, NodesAreHitExactly) {
  for (const double power : {1.0, 2.0, 3.0}) {
    const Axis axis = cubic(kUneven, power);
    for (std::size_t k = 0; k < axis.size(); ++k)
      EXPECT_EQ(interpolated(axis, axis.nodes[k], [&](double u) { return u; }),
                axis.coordinate(axis.nodes[k]))
          << power << ' ' << k;
  }
}

TEST(AxisStencil, OutsideIsTheNearestNode) {
  const auto square_of = [](double u) { return u * u; };
  for (const double power : {1.0, 2.0, 3.0}) {
    const Axis axis = cubic(kUneven, power);
    for (const double x : {-7.0, 0.0, 0.4999})
      EXPECT_EQ(interpolated(axis, x, square_of), square_of(axis.coordinate(axis.low())));
    for (const double x : {4.0001, 1e9})
      EXPECT_EQ(interpolated(axis, x, square_of), square_of(axis.coordinate(axis.high())));
  }
}

// As many nodes as there are: three hold a parabola, two a line, one a constant.
TEST(AxisStencil, FewerThanFourNodes) {
  const auto power_of = [](int n) { return [n](double u) { return std::pow(u, n); }; };
  const std::vector<std::vector<double>> nodes = {{2}, {1, 4}, {1, 2, 4}};
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Axis axis = cubic(nodes[n]);
    for (const double x : {1.1, 1.7, 2.5, 3.9}) {
      const double u = n == 0 ? 0 : axis.coordinate(x);
      EXPECT_EQ(axis.stencil(x).count, n + 1);
      EXPECT_NEAR(interpolated(axis, x, power_of(static_cast<int>(n))), std::pow(u, n), 1e-14)
          << n << ' ' << x;
    }
  }
}

// A linear axis goes on as locate() says, periodic or not.
TEST(AxisStencil, LinearAxesKeepTheirBrackets) {
  for (const double period : {0.0, 10.0}) {
    const Axis axis{"x", "1", kUneven, 1, period};
    for (const double x : {0.6, 1.9, 3.0, 4.0, 7.5}) {
      const Bracket bracket = axis.locate(x);
      const Stencil at = axis.stencil(x);
      double upper = 0, lower = 0;
      for (std::size_t k = 0; k < at.count; ++k)
        (at.node[k] == bracket.upper ? upper : lower) += at.weight[k];
      EXPECT_EQ(upper, bracket.upper_weight) << x;
      EXPECT_EQ(lower, 1 - bracket.upper_weight) << x;
    }
  }
}

TEST(AxisStencil, PeriodicAxesAreNotCubic) {
  Axis axis = cubic({0, 1, 2, 3});
  EXPECT_EQ(axis.defect(), "");
  axis.period = 6;
  EXPECT_THAT(axis.defect(), HasSubstr("both periodic and cubic"));
}

// |u| of the signed root has a kink at the origin, which no cubic through both sides would hold.
TEST(AxisStencil, ReachesNotAcrossAKink) {
  const Axis axis{"x", "1", {-9, -4, -1, 0, 1, 4, 9}, 2, 0, 0, true};
  const auto bent = [](double u) { return u < 0 ? 1 - 2 * u + u * u * u : 1 + 5 * u * u; };
  for (double x = -9; x <= 9; x += 0.37)
    EXPECT_NEAR(interpolated(axis, x, bent), bent(axis.coordinate(x)), 1e-12) << x;
  const Axis two{"x", "1", {-1, 0, 1, 4, 9}, 2, 0, 0, true};
  EXPECT_EQ(two.stencil(-0.5).count, 2u);
}

// Look-ups find the same nodes with the same weights, on every kind of axis. Weights are floats there.
TEST(AxisStencil, BoundAxisAgrees) {
  Axis soft{"x", "1", {-1, -0.4, 0.1, 0.5, 2}, 2, 0, 0.2, true};
  soft.softness = 0.3;
  for (const Axis& axis : {cubic(kUneven), cubic(kUneven, 2), cubic(kUneven, 3), soft,
                           Axis{"x", "1", {-9, -4, -1, 0, 1, 4, 9}, 2, 0, 0, true},
                           Axis{"x", "1", {-1, 0, 1, 4, 9}, 2, 0, 0, true}}) {
    const BoundAxis bound(axis, 3);
    for (double t = -0.05; t <= 1.05; t += 0.0137) {
      const double x = std::lerp(axis.low(), axis.high(), t);
      const Stencil at = axis.stencil(x);
      const BoundAxis::Taps taps = bound.at(x);
      std::vector<double> expected(axis.size()), found(axis.size());
      for (std::size_t k = 0; k < at.count; ++k) expected[at.node[k]] += at.weight[k];
      for (int k = 0; k < taps.count; ++k)
        found[static_cast<std::size_t>(taps.offset[k]) / 3] += double{taps.weight[k]};
      for (std::size_t k = 0; k < axis.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-5) << x << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace sunbeam
