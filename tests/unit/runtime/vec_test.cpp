#include "sunbeam/core/vec.h"

#include <gtest/gtest.h>

#include "sunbeam/core/frame.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/warp.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

TEST(Vec, CrossIsRightHandedAndOrthogonal) {
  const Vec3 z = cross({1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(z.x, 0);
  EXPECT_EQ(z.y, 0);
  EXPECT_EQ(z.z, 1);
  const Vec3 a{1, 2, 3}, b{-4, 5, 6}, c = cross(a, b);  // (12 - 15, -12 - 6, 5 + 8)
  EXPECT_EQ(c.x, -3);
  EXPECT_EQ(c.y, -18);
  EXPECT_EQ(c.z, 13);
}

TEST(Vec, ReflectTurnsAboutTheAxis) {
  const Vec3 w = normalize({1, 2, 3});
  const Vec3 about_z = reflect(w, {0, 0, 1});
  EXPECT_DOUBLE_EQ(about_z.x, -w.x);
  EXPECT_DOUBLE_EQ(about_z.y, -w.y);
  EXPECT_DOUBLE_EQ(about_z.z, w.z);
  const Vec3 h = normalize({0.2, -0.3, 0.9});
  EXPECT_NEAR(dot(reflect(w, h), h), dot(w, h), 1e-15);
  EXPECT_NEAR(length(reflect(w, h)), 1, 1e-15);
  EXPECT_NEAR(length(reflect(reflect(w, h), h) - w), 0, 1e-15);
}

TEST(Vec, SphericalDirection) {
  const Vec3 w = spherical_direction(kPi / 6, kPi / 3);  // sin 1/2, cos sqrt(3)/2 both ways
  EXPECT_NEAR(w.x, 0.25, 1e-15);
  EXPECT_NEAR(w.y, std::sqrt(3.0) / 4, 1e-15);
  EXPECT_NEAR(w.z, std::sqrt(3.0) / 2, 1e-15);
  EXPECT_NEAR(length(direction_from_cosine(w.z, kPi / 3) - w), 0, 1e-15);
}

TEST(Vec, RgbChannelsByIndex) {
  Rgb c(1, 2, 3);
  EXPECT_EQ(c[0], 1);
  EXPECT_EQ(c[1], 2);
  EXPECT_EQ(c[2], 3);
  c[1] = 6;
  EXPECT_EQ(c, Rgb(1, 6, 3));
  EXPECT_DOUBLE_EQ(mean(c), 10.0 / 3);
  EXPECT_EQ(max_component(c), 6);
  EXPECT_EQ(c * Rgb(2, 0.5, 1) - Rgb(1), Rgb(1, 2, 2));
  EXPECT_EQ(c / Rgb(1, 2, 3), Rgb(1, 3, 1));
}

TEST(Vec, IsFiniteSeesEveryChannel) {
  const double nan = std::nan("");
  EXPECT_TRUE(is_finite(Rgb(1, 2, 3)));
  EXPECT_FALSE(is_finite(Rgb(nan, 2, 3)));
  EXPECT_FALSE(is_finite(Rgb(1, 1 / std::sin(0.0), 3)));
  EXPECT_FALSE(is_finite(Rgb(1, 2, nan)));
}

// The basis must be orthonormal and right-handed for every normal, the poles and the seam z = 0 included.
TEST(Frame, OrthonormalRightHandedEverywhere) {
  std::vector<Vec3> normals = {{0, 0, 1},
                               {0, 0, -1},
                               {1, 0, 0},
                               {0, -1, 0},
                               normalize({1, 1, -0.0}),
                               normalize({1e-9, 0, -1}),
                               normalize({1e-5, 1e-5, -1})};
  Rng rng(1, 0);
  for (int i = 0; i < 100; ++i) normals.push_back(sample_sphere({rng.uniform(), rng.uniform()}));
  for (const Vec3& n : normals) {
    const Frame f = Frame::from_normal(n);
    EXPECT_NEAR(length(f.tangent), 1, 1e-14);
    EXPECT_NEAR(length(f.bitangent), 1, 1e-14);
    EXPECT_NEAR(dot(f.tangent, n), 0, 1e-14);
    EXPECT_NEAR(length(cross(f.tangent, f.bitangent) - n), 0, 1e-14);
  }
}

TEST(Frame, LocalAndWorldAreInverse) {
  const Frame f = Frame::from_normal(normalize({0.3, -0.5, -0.7}));
  const Vec3 w = normalize({0.1, 0.9, -0.4});
  EXPECT_NEAR(length(f.to_world(f.to_local(w)) - w), 0, 1e-15);
  EXPECT_NEAR(f.to_local(f.normal).z, 1, 1e-15);
}

}  // namespace
}  // namespace sunbeam
