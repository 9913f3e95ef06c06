// This is a camera with a thin lens, or a pinhole.
#pragma once

#include "runtime/tracer/ray.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

class Camera {
 public:
  Camera(const CameraView& view, int width, int height);

  // Returns the ray through the point (x, y) of the picture, in pixels from its top left corner; pixel (i, j)
  // covers [i, i + 1) x [j, j + 1). `u` in [0, 1)^2 chooses the point on a lens,
  // uniformly.
  Ray ray(double x, double y, const Point2& u) const {
    const Vec3 in_focus = top_left_ + x * pixel_x_ + y * pixel_y_;
    return has_lens_ ? through_lens(in_focus, u) : Ray{position_, normalize(in_focus)};
  }

 private:
  Ray through_lens(const Vec3& in_focus, const Point2& u) const;

  Vec3 position_;
  // These describe the picture at the distance in focus: its corner and one pixel to the right and down.
  Vec3 top_left_, pixel_x_, pixel_y_;
  Vec3 lens_x_, lens_y_;  // radii of the lens
  bool has_lens_;
};

}  // namespace sunbeam
