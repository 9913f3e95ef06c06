// The general walk, one scalar path at a time in three dimensions: rough films that may be anisotropic and
// whose facets may be met many times, over a pigment that may scatter.
//
// A path is split by what it has seen, each part with the estimator that suits it
// (docs/theory/scattering.md):
//   base    paths that reach the base. It forgets directions, so that everything before the last visit and
//           everything after it are independent: the product of two mean arrivals.
//   slab    paths that scatter in the pigment and never reach the base: the light's scattering events connect
//           to rays drawn from the other side.
//   facets  with multiple facets: light that leaves the microsurface upwards without ever having been below,
//           after more than one facet. The last mirroring facet connects to what came through facets alone.
// Throughputs are powers per wavelength; radiance pays (n0/n2)^2 where a connection lies below the film.
#pragma once

#include "bake/live/film/microsurface.h"
#include "bake/live/general/slab.h"
#include "bake/live/walks/kernels.h"

namespace sunbeam::walk {

using Powers = std::array<double, kMostWavelengths>;

// What the general walk has beyond Layers.
struct GeneralLayers {
  explicit GeneralLayers(const Material& material)
      : facets(material.roughness),
        multiple(material.has_multiple_facets()),
        slab{material.scattering_depth(), material.anisotropy} {}

  Microsurface facets;
  bool multiple;
  Slab slab;
};

// What a walk carries: power, or the chance of sample().
//
// sample() takes every turn at random, so the density of its directions has no closed form. But that density
// is the value of another material: one "wavelength" whose film reflects with the chance that sample()
// mirrors, over a pigment and a base that absorb nothing, for a walk that always goes on. With `chance` the
// same code therefore estimates densities where it estimates the rest with `power`; single facets lose
// nothing, since sample() pays for shadowing by weight.
enum class Carrying { power, chance };

// Where sample() ended.
struct GeneralSample {
  bool is_lost = false;
  Vec3 wi;
  bool is_first = false;                // one reflection by one upper facet, met at this cosine;
  double facet_cosine = 0, weight = 0;  // its throughput without the reflectance
};

class GeneralWalk {
 public:
  static constexpr int kWalks = 4;      // in one estimate
  static constexpr int kMostExits = 8;  // directions served by one walk
  // Scattering events of the bidirectional camera walk that connect: as many as it takes light to turn round.
  static constexpr int kMostCameraEvents = 16;

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
  struct Workspace;
  struct Exit;
  struct LightVisit;
  struct CameraRay;
  struct CameraVisit;
  struct PairedLightVisit;
  // Light that wanders from facet to facet.
  struct FacetPath {
    Place at;
    Powers power{};
    int order = 0;            // facets met before
    bool only_passed = true;  // none of them has mirrored
    double other = 0;  // else: the factor of meet_exit() there, had the path been made from its other end
  };
  struct Meeting {
    double factor, cosine;
  };
  struct Turn {
    enum Kind { lost, mirrored, passed } kind;
    double stays;
  };
  // Light that has met the film: on the side where it is now, its frame and travel, away from the facets.
  struct Outcome {
    bool is_lost = false;
    Side side = Side::outside;
    Vec3 travel;
    int facets = 1;                                      // met on the way
    double facet_cosine = 0, chance = 1, shadowing = 1;  // of the last one
  };

  static Workspace& workspace();

  // Film.
  void reflectances(const Place& at, double cosine, Powers& r) const;
  double mirror_chance(const Place& at, const Powers& r) const;
  double total(const Powers& power) const;
  Vec3 sample_normal(const Vec3& w, Rng& rng) const;
  bool pass_once(const Vec3& w, bool is_camera, Powers& power, Vec3& travel, Rng& rng) const;
  template <class OnPassing>
  bool enter(const Vec3& w, bool is_camera, Powers& power, Vec3& travel, Rng& rng,
             OnPassing on_passing) const;
  bool reflect_below(Vec3& travel, bool is_camera, Powers& power, Rng& rng) const;
  template <class Stays>
  Turn turn(Place& at, Powers& power, double through, double fixed, Rng& rng, Stays stays) const;
  template <class OnPassing>
  bool wander(Place at, Powers& power, Vec3& travel, Rng& rng, OnPassing on_passing) const;
  void follow_facets(const Vec3& wi, const Exit* exits, int count, Rng& rng, double* sums) const;
  bool pass(const Place& at, const Vec3& h, Place& passed) const;
  double shadowing(const Vec3& from, const Vec3& to, bool is_camera) const;
  bool choose_mirror(const Place& at, double cosine, Powers& power, double& chance, Rng& rng) const;
  void wander_freely(Place at, Powers& power, Outcome& out, Rng& rng) const;
  Outcome meet_film(Side side, const Vec3& x, bool is_entry, Powers& power, Rng& rng) const;

  // Pigment and base.
  void attenuate(double length, Powers& power) const;
  void leave_base(Powers& power, double arrived, Vec3& travel, Rng& rng) const;
  template <class Visit>
  void walk_below(Vec3 travel, Powers& power, Rng& rng, Visit& visit) const;
  Vec3 return_to_film(Vec3 travel, Powers& power, Rng& rng) const;

  // Connections; all add to `sums`.
  void draw_exit(const Vec3& wo, Exit& exit, Rng& rng) const;
  bool draw_entry(const Vec3& wi, const Exit* exits, int count, Powers& power, Vec3& travel, Rng& rng,
                  double* sums) const;
  void draw_rays(const Vec3& wo, Exit& exit, Rng& rng) const;
  void add_facets(const Vec3& wi, const Exit* exits, int count, Rng& rng, double* sums) const;
  void connect_facet(const FacetPath& path, const Exit& exit, double* sums) const;
  Meeting meet_exit(const Place& at, const Vec3& y, double origin) const;
  void mirror_towards(const FacetPath& path, const Vec3& y, double origin, const double* beyond,
                      double* sums) const;
  void pass_towards(const FacetPath& path, const Vec3& wo, double* sums) const;
  void scatter_towards(double depth, const Vec3& travel, const Powers& power, const Vec3& y, double origin,
                       const Powers& beyond, double others, double* sums) const;
  void add_base(const Powers& light, const Powers& camera, double walks, double* sums) const;

  const Layers& layers_;
  const GeneralLayers& general_;
  const double* importance_;
  const Kernels& kernels_;
  bool chance_;
  int count_;  // of powers
  int camera_events_;
};

}  // namespace sunbeam::walk
