// GeneralWalk::sample(): one walk from wo that takes every turn by chance and ends where light leaves.
#include "bake/live/general/film_crossing.h"
#include "bake/live/general/general_walk.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam::walk {
namespace {

// Light that has met the film: on the side where it is now, its frame and travel, away from the facets.
struct FilmOutcome {
  bool is_lost = false;
  Side side = Side::outside;
  Vec3 travel;
  int facets = 1;                                      // met on the way
  double facet_cosine = 0, chance = 1, shadowing = 1;  // of the last one
};

// One facet: true if it mirrors. `power` is multiplied by what that turn weighs.
bool choose_mirror(const WalkContext& walk, const Place& at, double cosine, Powers& power, double& chance,
                   Rng& rng) {
  FilmPowers film;
  walk.film_at(at, cosine, film);
  const double mirrors = walk.mirror_chance(at, film);
  const bool is_mirrored = rng.uniform() < mirrors;
  chance = is_mirrored ? mirrors : 1 - mirrors;
  const Powers& goes_on = is_mirrored ? film.reflectance : film.transmittance;
  for (int j = 0; j < walk.count; ++j) power[j] *= goes_on[j] / chance;
  return is_mirrored;
}

// From the first facet met at `at` until light leaves the film on either side.
void wander_freely(const WalkContext& walk, Place at, Powers& power, FilmOutcome& out, Rng& rng) {
  const Microsurface& facets = walk.general.facets;
  const Side start = at.side;
  const Vec3 unbent = -at.travel;  // in the frame of the other side
  for (out.facets = 1;; ++out.facets) {
    const Vec3 h = facets.sample_facet(at.travel, rng);
    out.facet_cosine = -dot(at.travel, h);
    if (choose_mirror(walk, at, out.facet_cosine, power, out.chance, rng)) {
      at = {at.side, reflect(-at.travel, h), at.depth};
    } else if (walk.layers.straight) {
      out.side = opposite(start);
      out.travel = unbent;
      return;
    } else {
      Place passed;
      out.is_lost = !pass_facet(walk, at, h, passed);  // rounding at total reflection
      if (out.is_lost) return;
      at = passed;
    }
    if (!facets.fly(at, rng)) {
      out.side = at.side;
      out.travel = at.travel;
      return;
    }
  }
}

// Light that travels along x, in the frame of `side`, meets the film there.
FilmOutcome meet_film(const WalkContext& walk, Side side, const Vec3& x, bool is_entry, Powers& power,
                      Rng& rng) {
  FilmOutcome out;
  if (walk.general.multiple) {
    Place at = walk.general.facets.first_facet(side, x, rng);
    at.is_entry = is_entry;
    wander_freely(walk, at, power, out, rng);
    return out;
  }
  const Vec3 w = -x, h = sample_normal(walk, w, rng);
  out.facet_cosine = dot(w, h);
  const bool is_mirrored =
      choose_mirror(walk, {side, x, 0, is_entry}, out.facet_cosine, power, out.chance, rng);
  out.side = is_mirrored ? side : opposite(side);
  out.travel = w;
  if (is_mirrored)
    out.travel = reflect(w, h);
  else if (walk.layers.bends)
    out.is_lost = !refract(w, h, index_ratio_from(walk, side), out.travel);
  out.is_lost = out.is_lost || out.travel.z <= 0;
  if (out.is_lost) return out;
  out.shadowing = !is_mirrored && walk.layers.straight ? 1 : shadowing(walk, w, out.travel, false);
  walk.scale(power, out.shadowing);
  return out;
}

// From below the film through pigment and base back up to it.
Vec3 return_to_film(const WalkContext& walk, Vec3 travel, Powers& power, Rng& rng) {
  const Slab& slab = walk.general.slab;
  double depth = 0;
  for (;;) {
    const Leg leg = next_leg(slab, depth, travel, rng);
    walk.attenuate(leg.length, power);
    if (leg.scatters) {
      depth = depth_after(leg, depth, travel);
      travel = slab.sample_phase(travel, rng);
      continue;
    }
    if (travel.z > 0) return travel;
    depth = 1;
    travel = sample_cosine({rng.uniform(), rng.uniform()});
    for (int j = 0; j < walk.count; ++j) power[j] *= walk.layers.albedo[j];
    if (walk.layers.product)
      for (int j = 0; j < walk.count; ++j)
        power[j] *= std::exp(-walk.layers.tau[j] / (leg.cosine * travel.z));
  }
}

}  // namespace

GeneralSample GeneralWalk::sample(const Vec3& wo, Powers& power, Rng& rng) const {
  const WalkContext& walk = context_;
  std::fill_n(power.begin(), walk.count, 1.0);
  FilmOutcome film = meet_film(walk, Side::outside, -wo, true, power, rng);
  GeneralSample result;
  result.is_first = film.side == Side::outside && film.facets == 1;
  result.facet_cosine = film.facet_cosine;
  result.weight = film.shadowing / film.chance;
  while (!film.is_lost && film.side == Side::inside)
    film = meet_film(walk, Side::inside, -return_to_film(walk, -film.travel, power, rng), false, power, rng);
  result.is_lost = film.is_lost;
  result.wi = film.travel;
  return result;
}

}  // namespace sunbeam::walk
