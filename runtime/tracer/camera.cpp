#include "runtime/tracer/camera.h"

namespace sunbeam {

Camera::Camera(const CameraView& view, int width, int height)
    : position_(view.position), has_lens_(view.lens_radius > 0) {
  const Vec3 forward = normalize(view.look_at - view.position);
  const Vec3 right = normalize(cross(forward, view.up));
  const Vec3 down = cross(forward, right);
  const int pixels = view.fov_axis == CameraView::FovAxis::horizontal ? width : height;
  const double pixel = 2 * view.focus_distance * std::tan(view.fov_deg * kPi / 360) / pixels;
  pixel_x_ = pixel * right;
  pixel_y_ = pixel * down;
  top_left_ = view.focus_distance * forward - (0.5 * width) * pixel_x_ - (0.5 * height) * pixel_y_;
  lens_x_ = view.lens_radius * right;
  lens_y_ = view.lens_radius * down;
}

Ray Camera::through_lens(const Vec3& in_focus, const Point2& u) const {
  const double radius = std::sqrt(u.x);
  const Turn turn(u.y);
  const Vec3 on_lens = (radius * turn.cosine) * lens_x_ + (radius * turn.sine) * lens_y_;
  return {position_ + on_lens, normalize(in_focus - on_lens)};
}

}  // namespace sunbeam
