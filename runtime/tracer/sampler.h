// This is where a path's random numbers come from, in a fixed order: two for the pixel, two for the lens, and
// at every vertex three for a light and three for the BSDF. Numbers of unknown count, for roulette and live
// models, come from the generator.
#pragma once

#include "sunbeam/bsdf.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

class Sampler {
 public:
  Sampler(std::uint64_t seed, std::uint64_t stream) : rng_(seed, stream) {}

  Point2 next2() {
    const double x = rng_.uniform();
    return {x, rng_.uniform()};
  }
  Random3 next3() { return random3(rng_); }
  Rng& rng() { return rng_; }

 private:
  Rng rng_;
};

}  // namespace sunbeam
