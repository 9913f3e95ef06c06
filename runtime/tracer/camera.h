// A pinhole camera.
#pragma once

#include "runtime/tracer/ray.h"
#include "runtime/tracer/scene.h"

namespace sunbeam {

class Camera {
 public:
  Camera(const CameraView& view, int width, int height);

  // Through the point (x, y) of the picture, in pixels from its top left corner; pixel (i, j) covers
  // [i, i + 1) x [j, j + 1).
  Ray ray(double x, double y) const;

 private:
  Vec3 position_;
  Vec3 top_left_, pixel_x_,
      pixel_y_;  // the picture at distance 1: its corner and one pixel to the right and down
};

}  // namespace sunbeam
