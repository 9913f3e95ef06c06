#include "bake/live/general/facets_part.h"

#include "bake/live/general/film_crossing.h"

namespace sunbeam::walk {
namespace {

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

// exp(-rate distance + depth of the origin) to the origin of a ray that `y`, the light on its way there, has
// to reach from `depth`; 0 if it leads elsewhere. The last term undoes what the two vertices' densities
// share: heights count once, depths twice.
double visibility(const Microsurface& facets, const Vec3& y, double depth, double origin) {
  const double way = y.z > 0 ? depth - origin : origin - depth;
  return way > 0 ? std::exp(origin - facets.rate(y) * way) : 0;
}

// By a facet at `at` along y to what lies at the depth `origin`, without the reflectance, 1/sr.
Meeting meet_exit(const Microsurface& facets, const Place& at, const Vec3& y, double origin) {
  const double visible = visibility(facets, y, at.depth, origin);
  if (visible == 0) return {0, 0};
  const Vec3 h = normalize(y - at.travel);
  if (h.z <= 0) return {0, 0};
  return {facets.mirror_density(at.travel, h) * visible / std::abs(y.z), dot(y, h)};
}

// What carries `beyond` (null: 1) is at the depth `origin`.
void mirror_towards(const WalkContext& walk, const FacetPath& path, const Vec3& y, double origin,
                    const double* beyond, double* sums) {
  const Meeting met = meet_exit(walk.general.facets, path.at, y, origin);
  if (met.factor == 0) return;
  FilmPowers film;
  walk.film_at(path.at, met.cosine, film);
  const double weight = path.only_passed ? 0.5 : path.other / (path.other + met.factor);
  const double factor = met.factor * (walk.is_chance ? 1 : weight) *
                        (path.at.side == Side::inside ? walk.layers.radiance_scale : 1) / kGeneralWalks;
  for (int j = 0; j < walk.count; ++j)
    sums[j] += path.power[j] * film.reflectance[j] * (beyond ? beyond[j] : 1) * factor;
}

// From the inside out along wo, by refraction.
void pass_towards(const WalkContext& walk, const FacetPath& path, const Vec3& wo, double* sums) {
  const Place& at = path.at;
  const double ratio = 1 / walk.layers.index_ratio;
  Vec3 h = wo + ratio * at.travel;
  if (h.z < 0) h = -h;
  h = normalize(h);
  if (dot(at.travel, h) >= 0 || dot(wo, h) <= 0) return;
  const double visible = visibility(walk.general.facets, wo, depth_from_other_side(at.depth), 0);
  FilmPowers film;
  walk.film_at(at, -dot(at.travel, h), film);
  const double factor = walk.general.facets.passing_density(at.travel, h, wo, ratio) * visible *
                        (walk.is_chance ? 1 : 0.5) / (wo.z * kGeneralWalks);
  for (int j = 0; j < walk.count; ++j) sums[j] += path.power[j] * film.transmittance[j] * factor;
}

// The facet that light is about to meet mirrors it towards an exit or lets it pass there.
void connect_facet(const WalkContext& walk, const FacetPath& path, const ExitPath& exit, double* sums) {
  const Place& at = path.at;
  if (at.side == Side::outside && path.order > 0) mirror_towards(walk, path, exit.wo, 0, nullptr, sums);
  for (int k = 0; k < exit.rays; ++k) {
    const Place& ray = exit.ray[k];
    if (ray.side == at.side)
      mirror_towards(walk, path, -ray.travel, ray.depth, &exit.ray_power[k * walk.count], sums);
  }
  if (at.side == Side::inside && path.only_passed && walk.layers.bends)
    pass_towards(walk, path, exit.wo, sums);
}

// One technique: light from wi that stays among facets, and at each of them what the exits see of it.
void follow_facets(const WalkContext& walk, const Vec3& wi, const ExitPath* exits, int count, Rng& rng,
                   double* sums) {
  const Microsurface& facets = walk.general.facets;
  FacetPath path{facets.first_facet(Side::outside, -wi, rng)};
  Place& at = path.at;
  at.is_entry = true;
  std::fill_n(path.power.begin(), walk.count, 1.0);
  const auto stays = [&](const Place& place) { return 1 - facets.escape_chance(place); };
  double origin = 0, least = 0;  // what stays after one facet is faint, and all that exits see
  for (;; ++path.order) {
    for (int k = 0; k < count; ++k) connect_facet(walk, path, exits[k], sums + k * walk.count);
    const Vec3 arrived = at.travel;
    const FacetTurn taken = take_turn(walk, at, path.power, 0, 0.5, rng, stays);
    if (taken.kind == FacetTurn::lost) return;
    if (taken.kind == FacetTurn::mirrored && path.only_passed) {
      path.only_passed = false;
      path.other = meet_exit(facets, {at.side, -at.travel, at.depth}, -arrived, origin).factor;
    }
    origin = at.depth;
    walk.scale(path.power, taken.stays);
    facets.fly_back(at, rng);
    least = path.order == 0 ? kFaint * walk.total(path.power) : least * taken.met;
    if (!(walk.total(path.power) > 0) || !walk.survives(path.power, least, rng)) return;
  }
}

}  // namespace

void draw_exit(const WalkContext& walk, const Vec3& wo, ExitPath& exit, Rng& rng) {
  exit.wo = wo;
  exit.rays = 0;
  const auto keep = [&](const Place& beyond, const Powers& power) {
    if (exit.rays == ExitPath::kMostRays || (exit.rays + 1) * walk.count > ExitPath::kRoom) return;
    exit.ray[exit.rays] = beyond;
    std::copy_n(power.data(), walk.count, &exit.ray_power[exit.rays++ * walk.count]);
  };
  exit.is_open = enter(walk, wo, true, exit.power, exit.up, rng, keep);
  exit.up = -exit.up;
}

void draw_rays(const WalkContext& walk, const Vec3& wo, ExitPath& exit, Rng& rng) {
  exit.wo = wo;
  exit.rays = 0;
  if (!walk.layers.straight) draw_exit(walk, wo, exit, rng);
}

// Both techniques, from either end: a path is connected at the last facet that mirrors or at the first.
void add_facets_part(const WalkContext& walk, const Vec3& wi, const ExitPath* exits, int count,
                     ExitPath& entry, Rng& rng, double* sums) {
  follow_facets(walk, wi, exits, count, rng, sums);
  if (walk.is_chance) return;  // the first facet of a sampled walk is taken by other chances than the last
  draw_rays(walk, wi, entry, rng);
  for (int k = 0; k < count; ++k) follow_facets(walk, exits[k].wo, &entry, 1, rng, sums + k * walk.count);
}

}  // namespace sunbeam::walk
