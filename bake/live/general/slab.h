// The scattering pigment between film and base: Henyey-Greenstein, homogeneous, one optical thickness.
//
// Lengths are in thicknesses of the slab, depth 0 at the film and 1 at the base. Free paths are drawn by
// scattering alone; absorption is a weight along the path, so that one walk serves all wavelengths.
#pragma once

#include "sunbeam/core/frame.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/core/vec.h"

namespace sunbeam::walk {

struct Slab {
  double scattering_depth = 0;  // sigma_s times thickness
  double g = 0;                 // mean cosine of a scattering event; > 0 is forward

  bool scatters() const { return scattering_depth > 0; }

  // The length to the next scattering event; infinite without any.
  double sample_free_path(Rng& rng) const { return -std::log(1 - rng.uniform()) / scattering_depth; }

  // exp(-depth / cosine) over a vertical distance, and density 1 / cosine: of a free path, over vertical
  // distance, up to the factor scattering_depth that all techniques share.
  double flight(double distance, double cosine) const {
    return std::exp(-scattering_depth * distance / cosine) / cosine;
  }

  // Henyey and Greenstein 1941, 1/sr, at the cosine between travel before and after.
  double phase(double cosine) const {
    const double squared = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) * kInvPi / (4 * squared * std::sqrt(squared));
  }

  // Travel after scattering, with density phase().
  Vec3 sample_phase(const Vec3& travel, Rng& rng) const {
    const double u = 2 * rng.uniform() - 1;
    // The usual inversion with g divided out, so that nothing cancels near g = 0.
    const double cosine =
        (2 * u + g * (u * u + 3) + 2 * g * g * u + g * g * g * (u * u - 1)) / (2 * square(1 + g * u));
    const Vec3 local = direction_from_cosine(std::clamp(cosine, -1.0, 1.0), 2 * kPi * rng.uniform());
    return Frame::from_normal(travel).to_world(local);
  }
};

// A straight leg of a walk between film and base, to the next scattering event or to either border.
struct Leg {
  double cosine;  // of its travel with the normal, without sign
  double length;
  bool scatters;
};
inline Leg next_leg(const Slab& slab, double depth, const Vec3& travel, Rng& rng) {
  const double cosine = std::max(std::abs(travel.z), 1e-12);
  const double to_border = (travel.z < 0 ? 1 - depth : depth) / cosine;
  const double free_path = slab.scatters() ? slab.sample_free_path(rng) : to_border;
  return {cosine, std::min(free_path, to_border), free_path < to_border};
}
// Where the leg ends, if it scatters.
inline double depth_after(const Leg& leg, double depth, const Vec3& travel) {
  return std::clamp(depth - leg.length * travel.z, 0.0, 1.0);
}

}  // namespace sunbeam::walk
