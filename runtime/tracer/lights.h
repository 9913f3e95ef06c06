// This file holds all sources of light of a scene: quads, spheres, points, far-off ones and the environment.
//
// A sample picks one of the sources that can be sampled (all but a constant environment) as light_choice.h
// tells; every density below has that choice in it and thus depends on the receiver.
#pragma once

#include <optional>
#include <vector>

#include "runtime/tracer/environment.h"
#include "runtime/tracer/light_choice.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/bsdf.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

struct LightSample {
  Vec3 wi;          // unit, world space, from the receiver towards the light
  double distance;  // infinite for what is far off
  Rgb radiance;     // arriving from wi if nothing is in between; of a Dirac light its irradiance at normal
                    // incidence
  double pdf;       // per solid angle (1/sr), > 0; of a Dirac light the chance of choosing it
  bool is_dirac;    // a point light, or a far-off one without size: no other technique can find it
};

// Holds what a ray sees when it meets a light, and the density with which sample() would have chosen that
// direction.
struct Emission {
  Rgb radiance;
  double pdf;  // per solid angle (1/sr); 0 if sample() never does
};

class Lights {
 public:
  // `scene` must outlive this.
  explicit Lights(const Scene& scene);

  // Draws a light by the first number and a direction to it by the others. The result is empty if there is
  // nothing to sample, or if the light chosen does not shine towards `from`.
  std::optional<LightSample> sample(const Vec3& from, const Random3& u) const;

  // Returns the emission that a ray from `from` with unit `direction` sees when it meets light `light`
  // (SurfaceHit::light) after `distance`. It is black on the back side.
  Emission surface(int light, const Vec3& from, const Vec3& direction, double distance) const;

  // Visits the Emission of everything that a ray from `from` with unit `direction` sees when it leaves the
  // scene.
  template <class Visit>
  void for_each_far_off(const Vec3& from, const Vec3& direction, Visit visit) const {
    visit(environment(from, direction));
    for (std::size_t i = 0; i < discs_.size(); ++i)
      if (dot(direction, discs_[i].towards) >= discs_[i].cos_radius)
        visit(Emission{discs_[i].radiance, choice_.chance(first_disc() + i, from) * discs_[i].pdf});
  }

 private:
  // Describes a directional light of some angular size.
  struct Disc {
    Vec3 towards;
    double cos_radius;
    Rgb radiance;
    double pdf;  // once chosen; 0 without size
  };

  std::size_t first_disc() const {
    return scene_.quad_lights.size() + scene_.sphere_lights.size() + scene_.point_lights.size();
  }
  Emission environment(const Vec3& from, const Vec3& direction) const;
  std::optional<LightSample> sample_directional(std::size_t light, double chance, const Point2& u) const;
  std::optional<LightSample> sample_environment(double chance, const Point2& u) const;

  const Scene& scene_;
  Environment environment_;
  LightChoice choice_;
  std::vector<Disc> discs_;  // of the directional lights; cos_radius 2, which nothing meets, of those without
                             // size
};

}  // namespace sunbeam
