// The general walk, one scalar path at a time in three dimensions: rough films that may be anisotropic and
// whose facets may be met many times, over a pigment that may scatter.
//
// A path is split by what it has seen, each part with the estimator that suits it
// (docs/theory/scattering.md):
//   base    paths that reach the base. It forgets directions, so that everything before the last visit and
//           everything after it are independent: the product of two mean arrivals.
//   slab    paths that scatter in the pigment and never reach the base: the light's scattering events connect
//           to rays drawn from the other side. Under a peaked phase function exit_guide.h finds the exits.
//   facets  with multiple facets: light that leaves the microsurface upwards without ever having been below,
//           after more than one facet. The last mirroring facet connects to what came through facets alone.
// Throughputs are powers per wavelength; radiance pays (n0/n2)^2 where a connection lies below the film.
#pragma once

#include "bake/live/general/walk_context.h"

namespace sunbeam::walk {

// Where sample() ended.
struct GeneralSample {
  bool is_lost = false;
  Vec3 wi;
  bool is_first = false;                // one reflection by one upper facet, met at this cosine;
  double facet_cosine = 0, weight = 0;  // its throughput without the reflectance
};

class GeneralWalk {
 public:
  static constexpr int kMostExits = 8;  // directions served by one walk

  // `importance` of each wavelength in choices, summing to 1. The arguments must outlive this.
  GeneralWalk(const Layers& layers, const GeneralLayers& general, const double* importance,
              const Kernels& kernels, Carrying carrying = Carrying::power);

  // Adds an estimate of rest(wo[k], wi), 1/sr per wavelength (as a chance: one), to sums[k * count + j].
  void add_unidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const;
  void add_bidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const;

  // The facets part alone, from one walk.
  void add_facets(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const;

  // One walk from wo. `power` is its throughput (unless is_first); every turn is taken by its mean power.
  GeneralSample sample(const Vec3& wo, Powers& power, Rng& rng) const;

 private:
  WalkContext context_;
};

}  // namespace sunbeam::walk
