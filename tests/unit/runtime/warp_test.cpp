#include "sunbeam/detail/warp.h"

#include <gtest/gtest.h>

#include "sunbeam/core/rng.h"
#include "tests/support/quadrature.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

// Solid angle per unit square area of a map u -> direction, by central differences.
template <class Map>
double solid_angle(Map map, const Point2& u) {
  constexpr double kStep = 1e-5;
  const Vec3 dx = map(Point2{u.x + kStep, u.y}) - map(Point2{u.x - kStep, u.y});
  const Vec3 dy = map(Point2{u.x, u.y + kStep}) - map(Point2{u.x, u.y - kStep});
  return length(cross(dx, dy)) / (4 * kStep * kStep);
}

const double kExponents[] = {0, 0.5, 1, 3, 40};

TEST(Warp, PowerCosineDensityIsTheMapsJacobian) {
  Rng rng(1, 0);
  for (const double exponent : kExponents) {
    const auto map = [&](const Point2& u) { return sample_power_cosine(exponent, u); };
    for (int i = 0; i < 20; ++i) {
      const Point2 u{0.05 + 0.9 * rng.uniform(), 0.05 + 0.9 * rng.uniform()};
      EXPECT_NEAR(solid_angle(map, u) * power_cosine_pdf(exponent, map(u).z), 1, 1e-6) << exponent;
    }
  }
}

TEST(Warp, PowerCosineInverts) {
  Rng rng(2, 0);
  for (const double exponent : kExponents)
    for (int i = 0; i < 50; ++i) {
      const Point2 u{rng.uniform(), rng.uniform()};
      const Point2 back = invert_power_cosine(exponent, sample_power_cosine(exponent, u));
      EXPECT_NEAR(back.x, u.x, 1e-13);
      EXPECT_NEAR(back.y, u.y, 1e-13);
    }
}

// 2 pi Int_0^1 (n + 1) / (2 pi) mu^n dmu = 1.
TEST(Warp, PowerCosineDensityIntegratesToOne) {
  for (const double exponent : kExponents) {
    const double total =
        test::integrate(0, 1, 200, [&](double mu) { return 2 * kPi * power_cosine_pdf(exponent, mu); });
    EXPECT_NEAR(total, 1, 1e-6) << exponent;
  }
}

TEST(Warp, CosineIsThePowerOne) {
  Rng rng(3, 0);
  for (int i = 0; i < 50; ++i) {
    const Point2 u{rng.uniform(), rng.uniform()};
    const Vec3 w = sample_cosine(u);
    EXPECT_NEAR(length(w - sample_power_cosine(1, u)), 0, 1e-14);
    EXPECT_NEAR(cosine_pdf(w.z), power_cosine_pdf(1, w.z), 1e-15);
    EXPECT_NEAR(invert_cosine(w).x, u.x, 1e-14);
    EXPECT_NEAR(invert_cosine(w).y, u.y, 1e-14);
  }
}

TEST(Warp, SphereDensityIsTheMapsJacobian) {
  Rng rng(4, 0);
  for (int i = 0; i < 20; ++i) {
    const Point2 u{0.05 + 0.9 * rng.uniform(), 0.05 + 0.9 * rng.uniform()};
    EXPECT_NEAR(solid_angle(sample_sphere, u) * sphere_pdf(), 1, 1e-6);
  }
  EXPECT_NEAR(sample_sphere({0, 0}).z, 1, 0);
  EXPECT_NEAR(sample_sphere({0.5, 0.25}).y, 1, 1e-15);
}

TEST(Warp, DensitiesVanishBelowTheHorizon) {
  EXPECT_EQ(cosine_pdf(-0.5), 0);
  EXPECT_EQ(power_cosine_pdf(0, -0.5), 0);
  EXPECT_EQ(power_cosine_pdf(3, 0), 0);
}

}  // namespace
}  // namespace sunbeam
