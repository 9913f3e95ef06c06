#include <gtest/gtest.h>

#include "bake/live/film/geometry.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

FilmGeometry film(Transmission transmission, const Roughness& roughness, double base_ior) {
  Material m;
  m.transmission = transmission;
  m.roughness = roughness;
  m.base_ior = base_ior;
  return FilmGeometry(m);
}

const Vec3 kUp{0, 0, 1};
const Vec3 kDirections[] = {spherical_direction(0.1, 0), spherical_direction(0.8, 0.5),
                            spherical_direction(1.3, 2)};

TEST(FilmGeometry, SmoothCrossingObeysSnellAndLosesNothing) {
  const FilmGeometry smooth = film(Transmission::refract, 0, 1.5);
  for (const Vec3& w : kDirections) {
    const auto inside = smooth.cross(w, kUp);
    ASSERT_TRUE(inside);
    EXPECT_NEAR(inside->direction.x, w.x / 1.5, 1e-15);
    EXPECT_NEAR(inside->direction.y, w.y / 1.5, 1e-15);
    EXPECT_EQ(inside->share, 1);
    const auto out = smooth.leave(inside->direction, kUp);
    ASSERT_TRUE(out);
    EXPECT_NEAR(length(out->direction - w), 0, 1e-14);
  }
}

TEST(FilmGeometry, NothingLeavesUnderTotalReflection) {
  const FilmGeometry smooth = film(Transmission::refract, 0, 1.5);
  EXPECT_FALSE(smooth.leave(spherical_direction(std::asin(1 / 1.5) + 0.01, 0.3), kUp));
  EXPECT_TRUE(smooth.leave(spherical_direction(std::asin(1 / 1.5) - 0.01, 0.3), kUp));
}

// "straight" has no shadowing; index-matched "refract" has that of w against itself.
TEST(FilmGeometry, UnbentCrossingKeepsTheDirection) {
  for (const Vec3& w : kDirections) {
    const auto straight = film(Transmission::straight, 0.3, 1.5).cross(w, kUp);
    const auto matched = film(Transmission::refract, 0.3, 1).cross(w, kUp);
    ASSERT_TRUE(straight && matched);
    EXPECT_EQ(length(straight->direction - w), 0);
    EXPECT_EQ(length(matched->direction - w), 0);
    EXPECT_EQ(straight->share, 1);
    EXPECT_EQ(matched->share, Ggx(0.3).g2_over_g1(w, w));
  }
}

// The facet bisects what it mirrors; what it bends stays in the plane of w and h, with sines as 1 : n2.
TEST(FilmGeometry, FacetsMirrorAndBendAboutTheirNormal) {
  const Roughness roughness{0.2, 0.5};
  const FilmGeometry rough = film(Transmission::refract, roughness, 1.5);
  const Ggx ggx(roughness);
  Rng rng(1, 0);
  int mirrored = 0, crossed = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 w = kDirections[i % 3], h = rough.visible_normal(w, {rng.uniform(), rng.uniform()});
    EXPECT_GT(dot(w, h), 0);
    if (const auto up = rough.mirror(w, h)) {
      ++mirrored;
      EXPECT_NEAR(length(normalize(w + up->direction) - h), 0, 1e-7);
      EXPECT_EQ(up->share, ggx.g2_over_g1(w, up->direction));
    }
    if (const auto inside = rough.cross(w, h)) {
      ++crossed;
      EXPECT_NEAR(length(cross(w, h) - 1.5 * cross(inside->direction, h)), 0, 1e-14);
      EXPECT_GT(dot(inside->direction, h), 0);
      EXPECT_EQ(inside->share, ggx.g2_over_g1(w, inside->direction));
    }
  }
  EXPECT_GT(mirrored, 150);
  EXPECT_GT(crossed, 250);
}

}  // namespace
}  // namespace sunbeam
