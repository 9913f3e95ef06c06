// GeneralWalk::sample(): one walk from wo that takes every turn by chance and ends where light leaves.
#include "bake/live/general/general_walk_parts.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam::walk {

// One facet: true if it mirrors. `power` is multiplied by what that turn weighs.
bool GeneralWalk::choose_mirror(const Place& at, double cosine, Powers& power, double& chance,
                                Rng& rng) const {
  Powers r;
  reflectances(at, cosine, r);
  const double mirrors = mirror_chance(at, r);
  const bool is_mirrored = rng.uniform() < mirrors;
  chance = is_mirrored ? mirrors : 1 - mirrors;
  for (int j = 0; j < count_; ++j) power[j] *= (is_mirrored ? r[j] : 1 - r[j]) / chance;
  return is_mirrored;
}

// From the first facet met at `at` until light leaves the film on either side.
void GeneralWalk::wander_freely(Place at, Powers& power, Outcome& out, Rng& rng) const {
  const Microsurface& facets = general_.facets;
  const Side start = at.side;
  const Vec3 unbent = -at.travel;  // in the frame of the other side
  for (out.facets = 1;; ++out.facets) {
    const Vec3 h = facets.sample_facet(at.travel, rng);
    out.facet_cosine = -dot(at.travel, h);
    if (choose_mirror(at, out.facet_cosine, power, out.chance, rng)) {
      at = {at.side, reflect(-at.travel, h), at.depth};
    } else if (layers_.straight) {
      out.side = opposite(start);
      out.travel = unbent;
      return;
    } else {
      Place passed;
      out.is_lost = !pass(at, h, passed);  // rounding at total reflection
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
GeneralWalk::Outcome GeneralWalk::meet_film(Side side, const Vec3& x, bool is_entry, Powers& power,
                                            Rng& rng) const {
  Outcome out;
  if (general_.multiple) {
    Place at = general_.facets.first_facet(side, x, rng);
    at.is_entry = is_entry;
    wander_freely(at, power, out, rng);
    return out;
  }
  const Vec3 w = -x, h = sample_normal(w, rng);
  out.facet_cosine = dot(w, h);
  const bool is_mirrored = choose_mirror({side, x, 0, is_entry}, out.facet_cosine, power, out.chance, rng);
  out.side = is_mirrored ? side : opposite(side);
  out.travel = w;
  if (is_mirrored)
    out.travel = reflect(w, h);
  else if (layers_.bends)
    out.is_lost =
        !refract(w, h, side == Side::outside ? layers_.index_ratio : 1 / layers_.index_ratio, out.travel);
  out.is_lost = out.is_lost || out.travel.z <= 0;
  if (out.is_lost) return out;
  out.shadowing = !is_mirrored && layers_.straight ? 1 : shadowing(w, out.travel, false);
  scale(power, count_, out.shadowing);
  return out;
}

// From below the film through pigment and base back up to it.
Vec3 GeneralWalk::return_to_film(Vec3 travel, Powers& power, Rng& rng) const {
  const Slab& slab = general_.slab;
  double depth = 0;
  for (;;) {
    const Leg leg = next_leg(slab, depth, travel, rng);
    attenuate(leg.length, power);
    if (leg.scatters) {
      depth = depth_after(leg, depth, travel);
      travel = slab.sample_phase(travel, rng);
      continue;
    }
    if (travel.z > 0) return travel;
    depth = 1;
    travel = sample_cosine({rng.uniform(), rng.uniform()});
    for (int j = 0; j < count_; ++j) power[j] *= layers_.albedo[j];
    if (layers_.product)
      for (int j = 0; j < count_; ++j) power[j] *= std::exp(-layers_.tau[j] / (leg.cosine * travel.z));
  }
}

GeneralSample GeneralWalk::sample(const Vec3& wo, Powers& power, Rng& rng) const {
  std::fill_n(power.begin(), count_, 1.0);
  Outcome film = meet_film(Side::outside, -wo, true, power, rng);
  GeneralSample result;
  result.is_first = film.side == Side::outside && film.facets == 1;
  result.facet_cosine = film.facet_cosine;
  result.weight = film.shadowing / film.chance;
  while (!film.is_lost && film.side == Side::inside)
    film = meet_film(Side::inside, -return_to_film(-film.travel, power, rng), false, power, rng);
  result.is_lost = film.is_lost;
  result.wi = film.travel;
  return result;
}

}  // namespace sunbeam::walk
