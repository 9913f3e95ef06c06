// The facets part of the rest: light that leaves the microsurface upwards without ever having been below,
// after more than one facet. It is followed from facet to facet; each connects to the rays of exits.
#pragma once

#include "bake/live/general/walk_context.h"

namespace sunbeam::walk {

// A direction drawn backwards from an exit to below the film.
struct ExitPath {
  // Room for the rays, in powers. Connections beyond it, to light that passes some fifty facets in a row at
  // twenty wavelengths, are left out. Estimates are unbiased but for that.
  static constexpr int kRoom = 1024, kMostRays = 128;

  Vec3 wo;
  bool is_open;
  Vec3 up;  // travel of light that takes this exit
  Powers power;
  // On its way, after each facet passed as long as none has mirrored.
  int rays;
  std::array<Place, kMostRays> ray;
  std::array<double, kRoom> ray_power;  // WalkContext::count for each
};

void draw_exit(const WalkContext& walk, const Vec3& wo, ExitPath& exit, Rng& rng);

// What the facets part needs of an exit.
void draw_rays(const WalkContext& walk, const Vec3& wo, ExitPath& exit, Rng& rng);

// Adds the share of one walk in the facets part of all exits to `sums`; `entry` is room to work in.
void add_facets_part(const WalkContext& walk, const Vec3& wi, const ExitPath* exits, int count,
                     ExitPath& entry, Rng& rng, double* sums);

}  // namespace sunbeam::walk
