// All sources of light of a scene: quads, points and the environment.
//
// A sample picks one of the sources that can be sampled (all but a constant environment) UNIFORMLY; every
// density below has that choice in it.
#pragma once

#include <optional>

#include "runtime/tracer/environment.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {

struct LightSample {
  Vec3 wi;          // unit, world space, from the receiver towards the light
  double distance;  // infinite for the environment
  Rgb radiance;     // arriving from wi if nothing is in between; for a point light its irradiance at normal
                    // incidence
  double pdf;       // per solid angle (1/sr), > 0; for a point light the chance of choosing it
  bool is_dirac;    // a point light: no other technique can find it
};

// What a ray sees when it meets a light, and the density with which sample() would have chosen that
// direction.
struct Emission {
  Rgb radiance;
  double pdf;  // per solid angle (1/sr); 0 if sample() never does
};

class Lights {
 public:
  // `scene` must outlive this.
  explicit Lights(const Scene& scene);

  // Empty if there is nothing to sample, or if the light chosen does not shine towards `from`.
  std::optional<LightSample> sample(const Vec3& from, Rng& rng) const;

  // Of a ray with unit `direction` that leaves the scene.
  Emission environment(const Vec3& direction) const;
  // Of a ray with unit `direction` that meets quad light `light` after `distance`. Black on the back side.
  Emission quad(int light, const Vec3& direction, double distance) const;

 private:
  std::optional<LightSample> sample_quad(std::size_t light, const Vec3& from, Rng& rng) const;
  std::optional<LightSample> sample_point(std::size_t light, const Vec3& from) const;
  std::optional<LightSample> sample_environment(Rng& rng) const;

  const Scene& scene_;
  Environment environment_;
  std::size_t count_;  // of sources that can be sampled
};

}  // namespace sunbeam
