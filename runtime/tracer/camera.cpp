#include "runtime/tracer/camera.h"

namespace sunbeam {

Camera::Camera(const CameraView& view, int width, int height) : position_(view.position) {
  const Vec3 forward = normalize(view.look_at - view.position);
  const Vec3 right = normalize(cross(forward, view.up));
  const Vec3 down = cross(forward, right);
  const double pixel = 2 * std::tan(view.fov_deg * kPi / 360) / height;
  pixel_x_ = pixel * right;
  pixel_y_ = pixel * down;
  top_left_ = forward - (0.5 * width) * pixel_x_ - (0.5 * height) * pixel_y_;
}

Ray Camera::ray(double x, double y) const {
  return {position_, normalize(top_left_ + x * pixel_x_ + y * pixel_y_)};
}

}  // namespace sunbeam
