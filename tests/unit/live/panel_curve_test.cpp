#include "sunbeam/detail/panel_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sunbeam {
namespace {

// A root, an essential singularity, an oscillation, a kink at a stated edge and a polynomial, side by side.
void five(double x, std::span<double> values) {
  values[0] = std::sqrt(x);
  values[1] = x > 0 ? std::exp(-0.01 / x) : 0;
  values[2] = 2 + std::cos(300 * x);
  values[3] = 1 + std::abs(x - 0.3);
  values[4] = 1 - x * (1 - x * x);
}

TEST(PanelCurve, FollowsFunctionsToTheTolerance) {
  const double edges[] = {0.3};
  const PanelCurve curve(5, five, {1e-6, 1e-12, 1e-6}, edges);
  ASSERT_EQ(curve.count(), 5u);
  ASSERT_EQ(curve.lanes(), 8u);
  for (int i = 0; i <= 10000; ++i) {
    const double x = i < 100 ? 1e-5 * (i + 1) : i / 10000.0;
    double expected[5], found[8];
    five(x, expected);
    curve.at(x, found);
    for (int k = 0; k < 5; ++k)
      EXPECT_NEAR(found[k], expected[k], 1e-6 * expected[k] + 1e-12) << k << ' ' << x;
  }
  EXPECT_LT(curve.panels(), 500u);
}

TEST(PanelCurve, ClampsAndIncludesBothEnds) {
  const PanelCurve curve(1, [](double x, std::span<double> v) { v[0] = 1 + x; }, {1e-9, 0, 1e-3});
  EXPECT_EQ(curve.lanes(), 1u);
  EXPECT_EQ(curve.panels(), 1u);
  double value = 0;
  for (const double x : {-1.0, 0.0, 1.0, 2.0}) {
    curve.at(x, &value);
    EXPECT_NEAR(value, 1 + std::clamp(x, 0.0, 1.0), 1e-14);
  }
}

// What cannot be resolved ends at the narrowest panel.
TEST(PanelCurve, HalvingEnds) {
  const PanelCurve curve(1, [](double x, std::span<double> v) { v[0] = x > 0.37 ? 2 : 1; }, {1e-6, 0, 1e-3});
  double value = 0;
  curve.at(0.36, &value);
  EXPECT_NEAR(value, 1, 1e-6);
  curve.at(0.38, &value);
  EXPECT_NEAR(value, 2, 1e-6);
  EXPECT_LT(curve.panels(), 30u);
}

}  // namespace
}  // namespace sunbeam
