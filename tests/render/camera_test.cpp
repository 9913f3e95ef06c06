// Where the camera looks: orientation, angle of view, and which way the picture is up.
#include "runtime/tracer/camera.h"

#include <gtest/gtest.h>

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
  expect_along(camera.ray(100, 50).direction, {0, 1, 0});
  expect_along(camera.ray(0, 0).direction, {-2, 1, 1});
  expect_along(camera.ray(200, 0).direction, {2, 1, 1});
  expect_along(camera.ray(0, 100).direction, {-2, 1, -1});
  EXPECT_EQ(camera.ray(3, 4).origin.x, 1);
  EXPECT_EQ(camera.ray(3, 4).origin.y, 2);
  EXPECT_EQ(camera.ray(3, 4).origin.z, 3);
}

TEST(Camera, UpTurnsThePicture) {
  const CameraView view{.position = {0, 0, 5}, .look_at = {0, 0, 0}, .up = {1, 0, 0}, .fov_deg = 90};
  const Camera camera(view, 100, 100);
  expect_along(camera.ray(50, 0).direction, {1, 0, -1});
  expect_along(camera.ray(100, 50).direction, {0, -1, -1});
}

}  // namespace
}  // namespace sunbeam
