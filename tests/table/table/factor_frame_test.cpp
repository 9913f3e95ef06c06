// The frame of a factored table's arrays, against its formulas in factor_frame.h.
#include "sunbeam/detail/factor_frame.h"

#include <gtest/gtest.h>

#include "sunbeam/core/rng.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {
namespace {

Material water(double base_ior, Transmission transmission = Transmission::refract) {
  Material material;
  material.transmission = transmission;
  material.exterior_ior = 1.33;
  material.base_ior = base_ior;
  material.roughness = {0.1, 0.4};
  return material;
}

// sin(theta_c) = n2/n0.
TEST(FactorFrame, CriticalCosine) {
  EXPECT_NEAR(critical_cosine(water(1.0)), std::cos(std::asin(1 / 1.33)), 1e-15);
  EXPECT_EQ(critical_cosine(water(1.33)), 0);
  EXPECT_EQ(critical_cosine(water(1.5)), 0);
}

// At grids that do not reach below, files of schema version 2 say the same.
TEST(FactorFrame, IsThatOfVersion2Above) {
  const Material material = water(1.5);
  const FactorFrame frame(material, false);
  EXPECT_FALSE(frame.is_warped());
  for (const double c : {1e-3, 0.2, 0.9, 1.0}) {
    EXPECT_EQ(frame.coordinate(c), c);
    EXPECT_EQ(frame.cosine(c), c);
    EXPECT_EQ(frame.pigment_cosine(c), arrival_cosine(material, c));
    EXPECT_EQ(frame.one_visit_cosine(c), material.cosine_below(c));
    EXPECT_EQ(frame.arrival(0.3, 0.7), std::log(0.3) + 0.7);
    EXPECT_EQ(frame.share(-1.5, 0.7), std::exp(-2.2));
  }
}

// u = (c - c*) / sqrt(|c - c*| + a) with a = sqrt(0.1 0.4) = 0.2, even in the coordinate.
TEST(FactorFrame, WarpedCosinesAreEvenAboutTheCriticalAngle) {
  for (const double base_ior : {1.0, 1.2, 1.33, 1.6}) {
    const FactorFrame frame(water(base_ior), true);
    ASSERT_TRUE(frame.is_warped());
    const double critical = critical_cosine(water(base_ior));
    const auto u = [&](double c) { return (c - critical) / std::sqrt(std::abs(c - critical) + 0.2); };
    for (const double c : {1e-3, 0.1, 0.5, 0.66, 0.9, 1.0}) {
      const double warped = (u(c) - u(1e-3)) / (u(1) - u(1e-3));
      EXPECT_NEAR(frame.coordinate(c), warped, 1e-14);
      EXPECT_NEAR(frame.cosine(warped), c, 1e-14);
    }
  }
}

// By central differences, whose error is 1e-6 of a third derivative of about 100.
TEST(FactorFrame, SlopeIsTheDerivative) {
  const FactorFrame frame(water(1.0), true);
  for (const double x : {0.1, 0.4, 0.6, 0.9})
    EXPECT_NEAR(frame.slope(x), (frame.cosine(x + 1e-3) - frame.cosine(x - 1e-3)) / 2e-3, 1e-4);
}

TEST(FactorFrame, SharesComeBack) {
  for (const Transmission transmission : {Transmission::straight, Transmission::refract})
    for (const bool reaches_below : {false, true}) {
      const FactorFrame frame(water(1.2, transmission), reaches_below);
      for (const double share : {0.9, 1e-3, 1e-6})
        for (const double decay : {0.0, 3.0})
          EXPECT_NEAR(frame.share(frame.arrival(share, 0), decay), share * std::exp(-decay), 1e-15);
      EXPECT_GE(frame.share(-100, 0), 0);
    }
}

// The pigment decays along 1/c where light passes straight on; where it bends, arrival holds the decay.
TEST(FactorFrame, DecayBelow) {
  EXPECT_EQ(FactorFrame(water(1.2, Transmission::straight), true).pigment_cosine(0.3), 0.3);
  EXPECT_EQ(1 / FactorFrame(water(1.2), true).pigment_cosine(0.3), 0);
  EXPECT_NEAR(FactorFrame(water(1.2), true).one_visit_cosine(1), std::hypot(1, 0.1), 1e-15);
  EXPECT_NEAR(FactorFrame(water(1.2), true).one_visit_cosine(0.1), 0.1, 1e-15);  // beyond the critical angle
}

// Snell: at least the asked cosine below, by n0 sin = n2 sin; else the direction stays as it is.
TEST(FactorFrame, EnteringCosines) {
  Material smooth = water(1.2);
  smooth.roughness = 0.0;
  smooth.absorption_per_nm = 0;
  EXPECT_NEAR(smooth.cosine_below(entering_cosine(smooth, 0.1, 0.05)), 0.05, 1e-12);
  EXPECT_EQ(entering_cosine(smooth, 0.9, 0.05), 0.9);
  smooth.absorption_per_nm = 3;  // tau = 6: the pigment lets exp(-30) pass at a cosine of 0.2
  EXPECT_NEAR(smooth.cosine_below(entering_cosine(smooth, 0.1)), 0.2, 1e-12);
  EXPECT_EQ(entering_cosine(water(1.2), 0.1), 0.1);
  smooth.base_ior = 1.4;
  EXPECT_EQ(entering_cosine(smooth, 0.1), 0.1);
}

}  // namespace
}  // namespace sunbeam
