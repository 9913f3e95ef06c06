// Where the camera looks: orientation, angle of view, and which way the picture is up.
#include "runtime/tracer/camera.h"

#include <gtest/gtest.h>

#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

void expect_along(const Vec3& direction, const Vec3& expected) {
  const Vec3 unit = normalize(expected);
  EXPECT_NEAR(direction.x, unit.x, 1e-12);
  EXPECT_NEAR(direction.y, unit.y, 1e-12);
  EXPECT_NEAR(direction.z, unit.z, 1e-12);
}

TEST(Camera, PictureIsUprightUnmirroredAndItsHeightSpansTheFov) {
  // From (1, 2, 3) along +y, z up: +x is to the right. 90 degrees vertical: half the height is tan 45 = 1,
  // half the width 2.
  const CameraView view{.position = {1, 2, 3}, .look_at = {1, 7, 3}, .fov_deg = 90};
  const Camera camera(view, 200, 100);
  expect_along(camera.ray(100, 50, {}).direction, {0, 1, 0});
  expect_along(camera.ray(0, 0, {}).direction, {-2, 1, 1});
  expect_along(camera.ray(200, 0, {}).direction, {2, 1, 1});
  expect_along(camera.ray(0, 100, {}).direction, {-2, 1, -1});
  EXPECT_EQ(camera.ray(3, 4, {}).origin.x, 1);
  EXPECT_EQ(camera.ray(3, 4, {}).origin.y, 2);
  EXPECT_EQ(camera.ray(3, 4, {}).origin.z, 3);
}

TEST(Camera, UpTurnsThePicture) {
  const CameraView view{.position = {0, 0, 5}, .look_at = {0, 0, 0}, .up = {1, 0, 0}, .fov_deg = 90};
  const Camera camera(view, 100, 100);
  expect_along(camera.ray(50, 0, {}).direction, {1, 0, -1});
  expect_along(camera.ray(100, 50, {}).direction, {0, -1, -1});
}

TEST(Camera, HorizontalFovSpansTheWidth) {
  const CameraView view{.position = {0, 0, 0},
                        .look_at = {0, 1, 0},
                        .fov_deg = 90,
                        .fov_axis = CameraView::FovAxis::horizontal};
  expect_along(Camera(view, 200, 100).ray(200, 0, {}).direction, {1, 1, 0.5});
}

// All rays of a picture point meet where it is in focus, and start all over the lens.
TEST(Camera, LensFocuses) {
  const CameraView view{
      .position = {0, 0, 0}, .look_at = {0, 7, 0}, .fov_deg = 90, .lens_radius = 0.5, .focus_distance = 4};
  const Camera camera(view, 100, 100);
  Rng rng(1, 1);
  double radius2 = 0;
  constexpr int kRays = 4000;
  for (int i = 0; i < kRays; ++i) {
    const Ray ray = camera.ray(75, 50, {rng.uniform(), rng.uniform()});
    const Vec3 in_focus = ray.origin + (4 / ray.direction.y) * ray.direction;
    EXPECT_NEAR(ray.origin.y, 0, 1e-12);
    EXPECT_NEAR(in_focus.x, 2, 1e-12);
    EXPECT_NEAR(in_focus.z, 0, 1e-12);
    radius2 += dot(ray.origin, ray.origin) / kRays;
    ASSERT_LE(length(ray.origin), 0.5);
  }
  // Uniform over the disc: mean of r^2 is R^2 / 2, with standard deviation R^2 / sqrt(12); 6 standard errors.
  EXPECT_NEAR(radius2, 0.125, 6 * 0.25 / std::sqrt(12.0 * kRays));
}

}  // namespace
}  // namespace sunbeam
