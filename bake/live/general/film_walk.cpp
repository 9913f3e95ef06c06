// The film as the general walk meets it, and the facets part of the rest.
#include "bake/live/general/general_walk_parts.h"

namespace sunbeam::walk {
namespace {

// Of the choices at a facet that look at no power, the share that mirrors: what has passed is worth less than
// its power to exits.
constexpr double kFixedMirrors = 0.7;

// exp(-rate distance + depth of the origin) to the origin of a ray that `y`, the light on its way there, has
// to reach from `depth`; 0 if it leads elsewhere. The last term undoes what the two vertices' densities
// share: heights count once, depths twice.
double visibility(const Microsurface& facets, const Vec3& y, double depth, double origin) {
  const double way = y.z > 0 ? depth - origin : origin - depth;
  return way > 0 ? std::exp(origin - facets.rate(y) * way) : 0;
}

}  // namespace

Vec3 GeneralWalk::sample_normal(const Vec3& w, Rng& rng) const {
  if (layers_.is_smooth()) return {0, 0, 1};
  return general_.facets.sample_facet(-w, rng);
}

// What single facets lose, for light that comes along `from` and goes on along `to`. As a chance there is no
// loss; but the camera's walk stands for one in the other direction.
double GeneralWalk::shadowing(const Vec3& from, const Vec3& to, bool is_camera) const {
  if (layers_.is_smooth()) return 1;
  const Ggx& ggx = general_.facets.ggx();
  if (chance_) return is_camera ? ggx.g1(to) / ggx.g1(from) : 1;
  return ggx.g2_over_g1(from, to);
}

// Single facets, from outside along w; `power` becomes the film's, `travel` the way down below it. False if
// it is lost.
bool GeneralWalk::pass_once(const Vec3& w, bool is_camera, Powers& power, Vec3& travel, Rng& rng) const {
  const Vec3 h = sample_normal(w, rng);
  Vec3 m = w;
  if (layers_.bends && (!refract(w, h, layers_.index_ratio, m) || m.z <= 0)) return false;
  Powers r;
  reflectances({Side::outside, -w, 0, !is_camera}, dot(w, h), r);
  const double share = layers_.straight ? 1 : shadowing(w, m, is_camera);
  for (int j = 0; j < count_; ++j) power[j] = (1 - r[j]) * share;
  travel = -m;
  return true;
}

// Light on its way up is thrown back; what leaves is not followed.
bool GeneralWalk::reflect_below(Vec3& travel, bool is_camera, Powers& power, Rng& rng) const {
  if (general_.multiple) {
    const Place at = general_.facets.first_facet(Side::inside, -travel, rng);
    return wander(at, power, travel, rng, [](const Place&, const Powers&) {});
  }
  const Vec3 h = sample_normal(travel, rng), m = reflect(travel, h);
  if (m.z <= 0) return false;
  Powers r;
  reflectances({Side::inside, -travel, 0}, dot(travel, h), r);
  const double share = shadowing(travel, m, is_camera);
  for (int j = 0; j < count_; ++j) power[j] *= r[j] * share;
  travel = -m;
  return true;
}

// The other side of a facet.
bool GeneralWalk::pass(const Place& at, const Vec3& h, Place& passed) const {
  passed = {opposite(at.side), -at.travel, depth_from_other_side(at.depth)};
  const double ratio = at.side == Side::outside ? layers_.index_ratio : 1 / layers_.index_ratio;
  return !layers_.bends || refract(-at.travel, h, ratio, passed.travel);
}

// One facet: light goes on mirrored or passing, in proportion to the power that stays(place) says is still of
// use there; `through`, the same for light that leaves facets as a whole behind (straight); the share `fixed`
// of the choice looks at no power. `power` is weighed for the choice alone.
template <class Stays>
GeneralWalk::Turn GeneralWalk::turn(Place& at, Powers& power, double through, double fixed, Rng& rng,
                                    Stays stays) const {
  const Vec3 h = general_.facets.sample_facet(at.travel, rng);
  Powers r;
  reflectances(at, -dot(at.travel, h), r);
  Place mirrored{at.side, reflect(-at.travel, h), at.depth}, passed;
  const double stays_r = stays(mirrored);
  double stays_t = through;
  if (!layers_.straight) stays_t = pass(at, h, passed) ? stays(passed) : 0;
  double share_r = 0, share_t = 0;
  for (int j = 0; j < count_; ++j) share_r += power[j] * r[j], share_t += power[j] * (1 - r[j]);
  share_r *= stays_r, share_t *= stays_t;
  const double sum = share_r + share_t;
  if (!(sum > 0)) return {Turn::lost, 0};
  double chance_r = share_r / sum;
  if (share_r > 0 && share_t > 0) chance_r = lerp(fixed, chance_r, kFixedMirrors);
  if (rng.uniform() < chance_r) {
    for (int j = 0; j < count_; ++j) power[j] *= r[j] / chance_r;
    at = mirrored;
    return {Turn::mirrored, stays_r};
  }
  for (int j = 0; j < count_; ++j) power[j] *= (1 - r[j]) / (1 - chance_r);
  at = passed;
  return {Turn::passed, stays_t};
}

// Many facets, from the first one met at `at` until light comes out below: `travel` is its way down. What
// would leave upwards is kept, with the chance that it meets another facet as its weight: others account for
// it. on_passing(beyond, power) as long as none has mirrored.
template <class OnPassing>
bool GeneralWalk::wander(Place at, Powers& power, Vec3& travel, Rng& rng, OnPassing on_passing) const {
  const Microsurface& facets = general_.facets;
  const double through = at.side == Side::outside ? 1 : 0;
  const auto stays = [&](const Place& place) {
    return place.side == Side::outside ? 1 - facets.escape_chance(place) : 1;
  };
  const double least = kFaint * total(power);
  for (bool only_passed = true;;) {
    const Turn taken = turn(at, power, through, 0, rng, stays);
    if (taken.kind == Turn::lost) return false;
    if (taken.kind == Turn::passed && layers_.straight) return true;
    only_passed = only_passed && taken.kind == Turn::passed;
    if (only_passed) on_passing(at, power);
    scale(power, count_, taken.stays);
    if (at.side == Side::outside) {
      facets.fly_back(at, rng);
    } else if (!facets.fly(at, rng)) {
      travel = -at.travel;
      return true;
    }
    if (!survives(power, count_, total(power), least, rng)) return false;
  }
}

// Facets part by one technique: light from wi that stays among facets, and at each of them what the exits see
// of it.
void GeneralWalk::follow_facets(const Vec3& wi, const Exit* exits, int count, Rng& rng, double* sums) const {
  const Microsurface& facets = general_.facets;
  FacetPath path{facets.first_facet(Side::outside, -wi, rng)};
  Place& at = path.at;
  at.is_entry = true;
  std::fill_n(path.power.begin(), count_, 1.0);
  double origin = 0, least = 0;  // what stays after one facet is faint, and all that exits see
  for (;; ++path.order) {
    for (int k = 0; k < count; ++k) connect_facet(path, exits[k], sums + k * count_);
    const Vec3 arrived = at.travel;
    const Turn taken = turn(at, path.power, 0, 0.5, rng,
                            [&](const Place& place) { return 1 - facets.escape_chance(place); });
    if (taken.kind == Turn::lost) return;
    if (taken.kind == Turn::mirrored && path.only_passed) {
      path.only_passed = false;
      path.other = meet_exit({at.side, -at.travel, at.depth}, -arrived, origin).factor;
    }
    origin = at.depth;
    scale(path.power, count_, taken.stays);
    facets.fly_back(at, rng);
    if (path.order == 0) least = kFaint * total(path.power);
    if (!(total(path.power) > 0) || !survives(path.power, count_, total(path.power), least, rng)) return;
  }
}

// Both techniques, from either end: a path is connected at the last facet that mirrors or at the first.
void GeneralWalk::add_facets(const Vec3& wi, const Exit* exits, int count, Rng& rng, double* sums) const {
  follow_facets(wi, exits, count, rng, sums);
  if (chance_) return;  // the first facet of a sampled walk is taken by other chances than the last
  Exit& entry = workspace().entry;
  draw_rays(wi, entry, rng);
  for (int k = 0; k < count; ++k) follow_facets(exits[k].wo, &entry, 1, rng, sums + k * count_);
}

// From outside along w to below the film; on_passing as in wander().
template <class OnPassing>
bool GeneralWalk::enter(const Vec3& w, bool is_camera, Powers& power, Vec3& travel, Rng& rng,
                        OnPassing on_passing) const {
  if (!general_.multiple) return pass_once(w, is_camera, power, travel, rng);
  std::fill_n(power.begin(), count_, 1.0);
  travel = -w;
  Place at = general_.facets.first_facet(Side::outside, -w, rng);
  at.is_entry = !is_camera;
  return wander(at, power, travel, rng, on_passing);
}

void GeneralWalk::draw_exit(const Vec3& wo, Exit& exit, Rng& rng) const {
  exit.wo = wo;
  exit.rays = 0;
  exit.is_open = enter(wo, true, exit.power, exit.up, rng, [&](const Place& beyond, const Powers& power) {
    if (exit.rays == kMostRays || (exit.rays + 1) * count_ > kRoom) return;
    exit.ray[exit.rays] = beyond;
    std::copy_n(power.data(), count_, &exit.ray_power[exit.rays++ * count_]);
  });
  exit.up = -exit.up;
}

// What the facets part needs of an exit.
void GeneralWalk::draw_rays(const Vec3& wo, Exit& exit, Rng& rng) const {
  exit.wo = wo;
  exit.rays = 0;
  if (!layers_.straight) draw_exit(wo, exit, rng);
}

// The light's way in, to its first arrival below; and, apart from it, the facets part of all exits.
bool GeneralWalk::draw_entry(const Vec3& wi, const Exit* exits, int count, Powers& power, Vec3& travel,
                             Rng& rng, double* sums) const {
  if (general_.multiple) add_facets(wi, exits, count, rng, sums);
  return enter(wi, false, power, travel, rng, [](const Place&, const Powers&) {});
}

// Facets part: the facet that light is about to meet mirrors it towards an exit or lets it pass there.
void GeneralWalk::connect_facet(const FacetPath& path, const Exit& exit, double* sums) const {
  const Place& at = path.at;
  if (at.side == Side::outside && path.order > 0) mirror_towards(path, exit.wo, 0, nullptr, sums);
  for (int k = 0; k < exit.rays; ++k) {
    const Place& ray = exit.ray[k];
    if (ray.side == at.side) mirror_towards(path, -ray.travel, ray.depth, &exit.ray_power[k * count_], sums);
  }
  if (at.side == Side::inside && path.only_passed && layers_.bends) pass_towards(path, exit.wo, sums);
}

// By a facet at `at` along y to what lies at the depth `origin`, without the reflectance, 1/sr.
GeneralWalk::Meeting GeneralWalk::meet_exit(const Place& at, const Vec3& y, double origin) const {
  const double visible = visibility(general_.facets, y, at.depth, origin);
  if (visible == 0) return {0, 0};
  const Vec3 h = normalize(y - at.travel);
  if (h.z <= 0) return {0, 0};
  return {general_.facets.mirror_density(at.travel, h) * visible / std::abs(y.z), dot(y, h)};
}

// What carries `beyond` (null: 1) is at the depth `origin`.
void GeneralWalk::mirror_towards(const FacetPath& path, const Vec3& y, double origin, const double* beyond,
                                 double* sums) const {
  const Meeting met = meet_exit(path.at, y, origin);
  if (met.factor == 0) return;
  Powers r;
  reflectances(path.at, met.cosine, r);
  const double weight = path.only_passed ? 0.5 : path.other / (path.other + met.factor);
  const double factor = met.factor * (chance_ ? 1 : weight) *
                        (path.at.side == Side::inside ? layers_.radiance_scale : 1) / kWalks;
  for (int j = 0; j < count_; ++j) sums[j] += path.power[j] * r[j] * (beyond ? beyond[j] : 1) * factor;
}

// From the inside out along wo, by refraction.
void GeneralWalk::pass_towards(const FacetPath& path, const Vec3& wo, double* sums) const {
  const Place& at = path.at;
  const double ratio = 1 / layers_.index_ratio;
  Vec3 h = wo + ratio * at.travel;
  if (h.z < 0) h = -h;
  h = normalize(h);
  if (dot(at.travel, h) >= 0 || dot(wo, h) <= 0) return;
  const double visible = visibility(general_.facets, wo, depth_from_other_side(at.depth), 0);
  Powers r;
  reflectances(at, -dot(at.travel, h), r);
  const double factor = general_.facets.passing_density(at.travel, h, wo, ratio) * visible *
                        (chance_ ? 1 : 0.5) / (wo.z * kWalks);
  for (int j = 0; j < count_; ++j) sums[j] += path.power[j] * (1 - r[j]) * factor;
}

void GeneralWalk::add_facets(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const {
  Exit* exit = workspace().exit.data();
  for (int k = 0; k < exits; ++k) draw_rays(wo[k], exit[k], rng);
  double found[kMostExits * kMostWavelengths];
  std::fill_n(found, exits * count_, 0.0);
  add_facets(wi, exit, exits, rng, found);
  for (int i = 0; i < exits * count_; ++i) sums[i] += found[i] * kWalks;  // connections are shares of so many
}

}  // namespace sunbeam::walk
