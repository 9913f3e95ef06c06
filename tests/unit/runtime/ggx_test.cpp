#include "sunbeam/detail/ggx.h"

#include <gtest/gtest.h>

#include "sunbeam/core/rng.h"
#include "tests/support/quadrature.h"
#include "tests/support/stats.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

const double kAlphas[] = {0.001, 0.1, 0.5, 1};
const double kAngles[] = {0, 0.7, 1.3, 1.5};  // of w, radians

TEST(Ggx, ProjectedNormalsIntegrateToOne) {
  for (const double alpha : kAlphas) {
    const Ggx ggx(alpha);
    const double total =
        test::integrate_normals(alpha, 4000, 1, [&](const Vec3& h) { return ggx.d(h) * h.z; });
    EXPECT_NEAR(total, 1, 1e-5) << alpha;
  }
}

// Holds only if G1 is the masking function of this D (Heitz 2014, eq. 19).
TEST(Ggx, VisibleNormalsIntegrateToOne) {
  for (const double alpha : kAlphas)
    for (const double theta : kAngles) {
      const Ggx ggx(alpha);
      const Vec3 w = spherical_direction(theta, 0.3);
      const double total =
          test::integrate_normals(alpha, 1500, 600, [&](const Vec3& h) { return ggx.visible_pdf(w, h); });
      EXPECT_NEAR(total, 1, 3e-5) << alpha << ", " << theta;
    }
}

// D at the pole is 1 / (pi alpha^2); Lambda at 45 degrees with alpha = 1 is (sqrt 2 - 1) / 2.
TEST(Ggx, ValuesByHand) {
  EXPECT_DOUBLE_EQ(Ggx(0.5).d({0, 0, 1}), 4 * kInvPi);
  const Vec3 w = spherical_direction(kPi / 4, 0);
  EXPECT_NEAR(Ggx(1).lambda(w), (std::sqrt(2.0) - 1) / 2, 1e-15);
  EXPECT_NEAR(Ggx(1).g1(w), 2 / (1 + std::sqrt(2.0)), 1e-15);
  EXPECT_EQ(Ggx(0.3).g1({0, 0, 1}), 1);
  EXPECT_EQ(Ggx(0.3).d(normalize({1, 0, -1e-3})), 0);
}

TEST(Ggx, ShadowingIsConsistent) {
  const Ggx ggx(0.6);
  for (const double a : kAngles)
    for (const double b : kAngles) {
      const Vec3 u = spherical_direction(a, 0), v = spherical_direction(b, 2);
      EXPECT_NEAR(ggx.g2_over_g1(u, v) * ggx.g1(u), ggx.g2(u, v), 1e-15);
      EXPECT_EQ(ggx.g2(u, v), ggx.g2(v, u));
      EXPECT_GE(ggx.g2(u, v), ggx.g1(u) * ggx.g1(v));  // heights correlated: more is seen by both
      EXPECT_LE(ggx.g2(u, v), std::min(ggx.g1(u), ggx.g1(v)));
      EXPECT_EQ(ggx.lambda(u), ggx.lambda({u.x, u.y, -u.z}));
    }
}

// Weak white furnace (Heitz 2014, sec. 5.2): reflection at visible normals alone, no shadowing, loses nothing
// if directions below the surface are counted.
TEST(Ggx, WeakWhiteFurnace) {
  const Ggx ggx(0.5);
  for (const double theta : {0.0, 0.7, 1.3}) {
    const Vec3 wo = spherical_direction(theta, 0.3);
    constexpr int kGrid = 1000;
    double total = 0;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const Vec3 wi = sample_sphere({(i + 0.5) / kGrid, (j + 0.5) / kGrid});
        total += ggx.reflection_pdf(wo, normalize(wo + wi)) / sphere_pdf();
      }
    EXPECT_NEAR(total / (kGrid * kGrid), 1, 1e-3) << theta;
  }
}

// The lobe over its density is g2_over_g1 / cos_i: what a walk multiplies by after reflecting.
TEST(Ggx, LobeOverDensity) {
  const Ggx ggx(0.3);
  const Vec3 wo = spherical_direction(0.9, 0.2), wi = spherical_direction(0.5, 2.9);
  const Vec3 h = normalize(wo + wi);
  EXPECT_NEAR(ggx.reflection(wo, wi, h) * wi.z / ggx.reflection_pdf(wo, h), ggx.g2_over_g1(wo, wi), 1e-14);
  EXPECT_NEAR(ggx.reflection_pdf(wo, h), ggx.visible_pdf(wo, h) / (4 * dot(wo, h)), 1e-14);
  EXPECT_NEAR(ggx.reflection(wo, wi, h), ggx.reflection(wi, wo, h), 1e-15);
}

// Cells in (tan(theta) / alpha squashed, phi). The expected share is quadrature of D_vis over each cell.
test::ChiSquare normals_against_density(double alpha, double theta, int samples) {
  constexpr int kPolar = 12, kAzimuthal = 16, kFine = 12;
  const Ggx ggx(alpha);
  const Vec3 w = spherical_direction(theta, 0.3);
  std::vector<test::Cell> cells(kPolar * kAzimuthal);
  for (int i = 0; i < kPolar * kFine; ++i)
    for (int j = 0; j < kAzimuthal * kFine; ++j) {
      const double x = (i + 0.5) / (kPolar * kFine), polar = std::atan(alpha * x / (1 - x));
      const Vec3 h = spherical_direction(polar, 2 * kPi * (j + 0.5) / (kAzimuthal * kFine));
      const double area = std::sin(polar) * square(std::cos(polar)) * alpha / square(1 - x) * 2 * kPi /
                          (kPolar * kFine * kAzimuthal * kFine);
      cells[i / kFine * kAzimuthal + j / kFine].expected += samples * area * ggx.visible_pdf(w, h);
    }
  Rng rng(11, static_cast<std::uint64_t>(theta * 10));
  for (int k = 0; k < samples; ++k) {
    const Vec3 h = ggx.sample_visible(w, {rng.uniform(), rng.uniform()});
    const double t = std::sqrt(h.x * h.x + h.y * h.y) / h.z / alpha, phi = std::atan2(h.y, h.x);
    const int i = std::min(kPolar - 1, static_cast<int>(t / (1 + t) * kPolar));
    const int j = static_cast<int>((phi < 0 ? phi + 2 * kPi : phi) / (2 * kPi) * kAzimuthal) % kAzimuthal;
    cells[i * kAzimuthal + j].observed += 1;
  }
  return test::chi_square(cells);
}

// 16 tests, false alarm 1e-4 in all (fixed number of samples: Poisson cells overstate the spread by a
// little).
TEST(Ggx, SampledNormalsFollowTheDensity) {
  for (const double alpha : kAlphas)
    for (const double theta : kAngles) {
      const auto result = normals_against_density(alpha, theta, 100000);
      EXPECT_GT(result.degrees, 20) << alpha << ", " << theta;
      EXPECT_GT(result.p_value, test::sidak(1e-4, 16)) << alpha << ", " << theta;
    }
}

TEST(Ggx, SampledNormalsAreUnitAndFaceTheView) {
  Rng rng(12, 0);
  for (const double alpha : kAlphas)
    for (const double theta : kAngles) {
      const Vec3 w = spherical_direction(theta, 0.3);
      for (int i = 0; i < 200; ++i) {
        const Vec3 h = Ggx(alpha).sample_visible(w, {rng.uniform(), rng.uniform()});
        EXPECT_NEAR(length(h), 1, 1e-14);
        EXPECT_GT(h.z, 0);
        EXPECT_GE(dot(w, h), -1e-9);
      }
    }
}

}  // namespace
}  // namespace sunbeam
