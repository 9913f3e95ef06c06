// This file holds what is known of a picture while its samples come in: mean and spread of every pixel, and
// means of what its camera rays met first.
#pragma once

#include <cstdint>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {

// Says what a camera ray met first. Directions are in world space, on the viewer's side.
struct FirstHit {
  bool on_surface = false;  // a light or nothing otherwise, and all below is 0
  Rgb albedo;  // throughput of the BSDF sample: its mean is the directional albedo, mirror included
  Vec3 shading_normal, geometric_normal;
  double depth = 0;  // distance from the camera, scene units
  double film_thickness_nm = 0;
};

// Keeps mean and spread of the samples of one pixel (Welford 1962: no cancellation). The result depends on
// the order of the samples alone, not on where a render paused between them.
class PixelSums {
 public:
  PixelSums() = default;
  // Starts as if `count` samples of this mean had come in, `variance_of_mean` estimated from them.
  PixelSums(std::uint32_t count, const Rgb& mean, const Rgb& variance_of_mean)
      : count_(count), mean_(mean), squares_(variance_of_mean * (count * (count - 1.0))) {}

  void add(const Rgb& sample) {
    count_ += 1;
    const Rgb before = sample - mean_;
    mean_ += before * (1.0 / count_);
    squares_ += before * (sample - mean_);
  }
  std::uint32_t count() const { return count_; }
  const Rgb& mean() const { return mean_; }
  Rgb variance_of_mean() const { return count_ < 2 ? Rgb() : squares_ / (count_ * (count_ - 1.0)); }

 private:
  std::uint32_t count_ = 0;
  Rgb mean_, squares_;
};

}  // namespace sunbeam
