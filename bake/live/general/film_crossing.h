// How light crosses the film or is thrown back by it: by one facet, or by as many as it meets.
#pragma once

#include "bake/live/general/walk_context.h"

namespace sunbeam::walk {

// What a facet has done with light, the weight of what stays, and that of the facet, which roulette forgives.
struct FacetTurn {
  enum Kind { lost, mirrored, passed } kind;
  double stays, met;
};

// A facet, and the factor of the light that meets it.
struct FacetMet {
  Vec3 normal;
  double weight;
};

// The facet that light from outside meets along `travel`. Beyond total reflection few facets let it pass, so
// half of them are drawn from the cone of those that do, evenly; no weight exceeds two.
inline FacetMet meet_from_outside(const WalkContext& walk, const Vec3& travel, Rng& rng) {
  const Microsurface& facets = walk.general.facets;
  const double critical = walk.general.critical_cosine;
  if (-travel.z >= critical) return {facets.sample_facet(travel, rng), 1};
  Vec3 h;
  if (rng.uniform() < 0.5)
    h = facets.sample_facet(travel, rng);
  else
    h = Frame::from_normal(-travel).to_world(
        direction_from_cosine(lerp(rng.uniform(), critical, 1), 2 * kPi * rng.uniform()));
  const double visible = facets.visible_density(travel, h);
  const double drawn = dot(-travel, h) > critical ? 1 / (2 * kPi * (1 - critical)) : 0;
  return {h, visible > 0 ? visible / lerp(0.5, visible, drawn) : 0};
}

// The facet that light against `w` meets, of single ones.
inline Vec3 sample_normal(const WalkContext& walk, const Vec3& w, Rng& rng) {
  if (walk.layers.is_smooth()) return {0, 0, 1};
  return walk.general.facets.sample_facet(-w, rng);
}

// What single facets lose, for light that comes along `from` and goes on along `to`. As a chance there is no
// loss; but the camera's walk stands for one in the other direction.
inline double shadowing(const WalkContext& walk, const Vec3& from, const Vec3& to, bool is_camera) {
  if (walk.layers.is_smooth()) return 1;
  const Ggx& ggx = walk.general.facets.ggx();
  if (walk.is_chance) return is_camera ? ggx.g1(to) / ggx.g1(from) : 1;
  return ggx.g2_over_g1(from, to);
}

// The index of the medium on this side over that of the other.
inline double index_ratio_from(const WalkContext& walk, Side side) {
  return side == Side::outside ? walk.layers.index_ratio : 1 / walk.layers.index_ratio;
}

// Single facets, from outside along w; `power` becomes the film's, `travel` the way down below it. False if
// it is lost.
inline bool pass_once(const WalkContext& walk, const Vec3& w, bool is_camera, Powers& power, Vec3& travel,
                      Rng& rng) {
  const FacetMet met = walk.layers.is_smooth() ? FacetMet{{0, 0, 1}, 1} : meet_from_outside(walk, -w, rng);
  const Vec3& h = met.normal;
  Vec3 m = w;
  if (met.weight == 0) return false;
  if (walk.layers.bends && (!refract(w, h, walk.layers.index_ratio, m) || m.z <= 0)) return false;
  FilmPowers film;
  walk.film_at({Side::outside, -w, 0, !is_camera}, dot(w, h), film);
  const double share = met.weight * (walk.layers.straight ? 1 : shadowing(walk, w, m, is_camera));
  for (int j = 0; j < walk.count; ++j) power[j] = film.transmittance[j] * share;
  travel = -m;
  return true;
}

// The other side of a facet. False under total reflection.
inline bool pass_facet(const WalkContext& walk, const Place& at, const Vec3& h, Place& passed) {
  passed = {opposite(at.side), -at.travel, depth_from_other_side(at.depth)};
  return !walk.layers.bends || refract(-at.travel, h, index_ratio_from(walk, at.side), passed.travel);
}

// Of the choices at a facet that look at no power, the share that mirrors: what has passed is worth less than
// its power to exits.
inline constexpr double kFixedMirrors = 0.7;

// One facet: light goes on mirrored or passing, in proportion to the power that stays(place) says is still of
// use there; `through`, the same for light that leaves facets as a whole behind (straight); the share `fixed`
// of the choice looks at no power. `power` is weighed for facet and choice alone.
template <class Stays>
FacetTurn take_turn(const WalkContext& walk, Place& at, Powers& power, double through, double fixed, Rng& rng,
                    Stays stays) {
  const FacetMet met = at.side == Side::outside
                           ? meet_from_outside(walk, at.travel, rng)
                           : FacetMet{walk.general.facets.sample_facet(at.travel, rng), 1};
  if (met.weight == 0) return {FacetTurn::lost, 0, 1};
  walk.scale(power, met.weight);
  const Vec3& h = met.normal;
  FilmPowers film;
  walk.film_at(at, -dot(at.travel, h), film);
  const Powers &r = film.reflectance, &t = film.transmittance;
  Place mirrored{at.side, reflect(-at.travel, h), at.depth}, passed;
  const double stays_r = stays(mirrored);
  double stays_t = through;
  if (!walk.layers.straight) stays_t = pass_facet(walk, at, h, passed) ? stays(passed) : 0;
  double share_r = 0, share_t = 0;
  for (int j = 0; j < walk.count; ++j) share_r += power[j] * r[j], share_t += power[j] * t[j];
  share_r *= stays_r, share_t *= stays_t;
  const double sum = share_r + share_t;
  if (!(sum > 0)) return {FacetTurn::lost, 0, 1};
  double chance_r = share_r / sum;
  if (share_r > 0 && share_t > 0) chance_r = lerp(fixed, chance_r, kFixedMirrors);
  if (rng.uniform() < chance_r) {
    for (int j = 0; j < walk.count; ++j) power[j] *= r[j] / chance_r;
    at = mirrored;
    return {FacetTurn::mirrored, stays_r, met.weight};
  }
  for (int j = 0; j < walk.count; ++j) power[j] *= t[j] / (1 - chance_r);
  at = passed;
  return {FacetTurn::passed, stays_t, met.weight};
}

// Many facets, from the first one met at `at` until light comes out below: `travel` is its way down. What
// would leave upwards is kept, with the chance that it meets another facet as its weight: others account for
// it. on_passing(beyond, power) as long as none has mirrored.
template <class OnPassing>
bool wander(const WalkContext& walk, Place at, Powers& power, Vec3& travel, Rng& rng, OnPassing on_passing) {
  const Microsurface& facets = walk.general.facets;
  const double through = at.side == Side::outside ? 1 : 0;
  const auto stays = [&](const Place& place) {
    return place.side == Side::outside ? 1 - facets.escape_chance(place) : 1;
  };
  double least = kFaint * walk.total(power);
  for (bool only_passed = true;;) {
    const FacetTurn taken = take_turn(walk, at, power, through, 0, rng, stays);
    least *= taken.met;
    if (taken.kind == FacetTurn::lost) return false;
    if (taken.kind == FacetTurn::passed && walk.layers.straight) return true;
    only_passed = only_passed && taken.kind == FacetTurn::passed;
    if (only_passed) on_passing(at, power);
    walk.scale(power, taken.stays);
    if (at.side == Side::outside) {
      facets.fly_back(at, rng);
    } else if (!facets.fly(at, rng)) {
      travel = -at.travel;
      return true;
    }
    if (!walk.survives(power, least, rng)) return false;
  }
}

// From outside along w to below the film; on_passing as in wander().
template <class OnPassing>
bool enter(const WalkContext& walk, const Vec3& w, bool is_camera, Powers& power, Vec3& travel, Rng& rng,
           OnPassing on_passing) {
  if (!walk.general.multiple) return pass_once(walk, w, is_camera, power, travel, rng);
  std::fill_n(power.begin(), walk.count, 1.0);
  travel = -w;
  Place at = walk.general.facets.first_facet(Side::outside, -w, rng);
  at.is_entry = !is_camera;
  return wander(walk, at, power, travel, rng, on_passing);
}

// Light on its way up is thrown back; what leaves is not followed.
inline bool reflect_below(const WalkContext& walk, Vec3& travel, bool is_camera, Powers& power, Rng& rng) {
  if (walk.general.multiple) {
    const Place at = walk.general.facets.first_facet(Side::inside, -travel, rng);
    return wander(walk, at, power, travel, rng, [](const Place&, const Powers&) {});
  }
  const Vec3 h = sample_normal(walk, travel, rng), m = reflect(travel, h);
  if (m.z <= 0) return false;
  FilmPowers film;
  walk.film_at({Side::inside, -travel, 0}, dot(travel, h), film);
  const double share = shadowing(walk, travel, m, is_camera);
  for (int j = 0; j < walk.count; ++j) power[j] *= film.reflectance[j] * share;
  travel = -m;
  return true;
}

}  // namespace sunbeam::walk
