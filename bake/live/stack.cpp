#include "bake/live/stack.h"

#include "sunbeam/core/warp.h"

namespace sunbeam::walk {
namespace {

// Room for the rays of an exit, in powers. What passes more facets than fit, some fifty in a row at twenty
// wavelengths, is left out.
constexpr int kRoom = 1024, kMostRays = 128;

// A walk that has lost all but this of its power goes on by roulette.
constexpr double kFaint = 0.15;

// Of the choices at a facet that look at no power, the share that mirrors: what has passed is worth less than
// its power to exits.
constexpr double kFixedMirrors = 0.7;

void scale(Powers& power, int count, double factor) {
  for (int j = 0; j < count; ++j) power[j] *= factor;
}

// Keeps `power` at `least` in the mean by ending walks below it. False if this one ends.
bool survives(Powers& power, int count, double total, double least, Rng& rng) {
  if (total >= least) return true;
  if (!(rng.uniform() * least < total)) return false;
  scale(power, count, least / total);
  return true;
}

// exp(-rate distance + depth of the origin) to the origin of a ray that `y`, the light on its way there, has
// to reach from `depth`; 0 if it leads elsewhere. The last term undoes what the two vertices' densities
// share: heights count once, depths twice.
double visibility(const Microsurface& facets, const Vec3& y, double depth, double origin) {
  const double way = y.z > 0 ? depth - origin : origin - depth;
  return way > 0 ? std::exp(origin - facets.rate(y) * way) : 0;
}

}  // namespace

// A Place that costs nothing to leave uninitialised.
struct Stack::PackedPlace {
  Side side;
  double x, y, z, depth;
};

// A direction drawn backwards from an exit to below the film.
struct Stack::Exit {
  Vec3 wo;
  bool is_open;
  Vec3 up;  // travel of light that takes this exit
  Powers power;
  // On its way, after each facet passed as long as none has mirrored.
  int rays;
  std::array<PackedPlace, kMostRays> ray;
  std::array<double, kRoom> ray_power;  // count() for each

  Place place(int k) const { return {ray[k].side, {ray[k].x, ray[k].y, ray[k].z}, ray[k].depth}; }
};

Stack::Stack(const Layers& layers, const StackLayers& stack, const double* importance, const Kernels& kernels,
             Carrying carrying)
    : layers_(layers),
      stack_(stack),
      importance_(importance),
      kernels_(kernels),
      chance_(carrying == Carrying::chance),
      count_(chance_ ? 1 : layers.count),
      camera_events_(std::min(2 + static_cast<int>(stack.slab.g / (1 - stack.slab.g)), kMostCameraEvents)) {}

double Stack::total(const Powers& power) const {
  double sum = 0;
  for (int j = 0; j < count_; ++j) sum += power[j];
  return sum;
}

// How often sample() takes a facet to mirror.
double Stack::mirror_chance(const Place& at, const Powers& r) const {
  double mean = 0;
  for (int j = 0; j < layers_.count; ++j) mean += importance_[j] * r[j];
  mean = std::clamp(mean, 0.0, 1.0);
  return at.is_entry ? layers_.entry_chance(mean) : mean;
}

void Stack::reflectances(const Place& at, double cosine, Powers& r) const {
  const FilmSide& film = at.side == Side::outside ? layers_.film : layers_.film_below;
  kernels_.reflectances(film, layers_.phases, std::clamp(cosine, 0.0, 1.0), r.data());
  if (chance_) r[0] = mirror_chance(at, r);
}

Vec3 Stack::sample_normal(const Vec3& w, Rng& rng) const {
  if (layers_.is_smooth()) return {0, 0, 1};
  return stack_.facets.sample_facet(-w, rng);
}

// What single facets lose, for light that comes along `from` and goes on along `to`. As a chance there is no
// loss; but the camera's walk stands for one in the other direction.
double Stack::shadowing(const Vec3& from, const Vec3& to, bool is_camera) const {
  if (layers_.is_smooth()) return 1;
  const Ggx& ggx = stack_.facets.ggx();
  if (chance_) return is_camera ? ggx.g1(to) / ggx.g1(from) : 1;
  return ggx.g2_over_g1(from, to);
}

// Single facets, from outside along w; `power` becomes the film's, `travel` the way down below it. False if
// it is lost.
bool Stack::pass_once(const Vec3& w, bool is_camera, Powers& power, Vec3& travel, Rng& rng) const {
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
bool Stack::reflect_below(Vec3& travel, bool is_camera, Powers& power, Rng& rng) const {
  if (stack_.multiple) {
    const Place at = stack_.facets.first_facet(Side::inside, -travel, rng);
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
bool Stack::pass(const Place& at, const Vec3& h, Place& passed) const {
  passed = {opposite(at.side), -at.travel, depth_from_other_side(at.depth)};
  const double ratio = at.side == Side::outside ? layers_.index_ratio : 1 / layers_.index_ratio;
  return !layers_.bends || refract(-at.travel, h, ratio, passed.travel);
}

// One facet: light goes on mirrored or passing, in proportion to the power that stays(place) says is still of
// use there; `through`, the same for light that leaves facets as a whole behind (straight); the share `fixed`
// of the choice looks at no power. `power` is weighed for the choice alone.
template <class Stays>
Stack::Turn Stack::turn(Place& at, Powers& power, double through, double fixed, Rng& rng, Stays stays) const {
  const Vec3 h = stack_.facets.sample_facet(at.travel, rng);
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
bool Stack::wander(Place at, Powers& power, Vec3& travel, Rng& rng, OnPassing on_passing) const {
  const Microsurface& facets = stack_.facets;
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
void Stack::follow_facets(const Vec3& wi, const Exit* exits, int count, Rng& rng, double* sums) const {
  const Microsurface& facets = stack_.facets;
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
void Stack::add_facets(const Vec3& wi, const Exit* exits, int count, Rng& rng, double* sums) const {
  follow_facets(wi, exits, count, rng, sums);
  if (chance_) return;  // the first facet of a sampled walk is taken by other chances than the last
  Exit entry;
  draw_rays(wi, entry, rng);
  for (int k = 0; k < count; ++k) follow_facets(exits[k].wo, &entry, 1, rng, sums + k * count_);
}

void Stack::attenuate(double length, Powers& power) const {
  if (chance_ || layers_.product) return;
  if (layers_.same_tau) {
    if (layers_.least_tau > 0) scale(power, count_, std::exp(-layers_.least_tau * length));
    return;
  }
  kernels_.attenuate(layers_.tau.data(), length, count_, power.data());
}

// Up from the base, which light reached at the cosine `arrived`.
void Stack::leave_base(Powers& power, double arrived, Vec3& travel, Rng& rng) const {
  if (chance_) {
    travel = sample_cosine({rng.uniform(), rng.uniform()});
    return;
  }
  const auto up = layers_.guide.sample(rng.uniform());
  travel = direction_from_cosine(std::sqrt(up.square), 2 * kPi * rng.uniform());
  for (int j = 0; j < count_; ++j) power[j] *= layers_.albedo[j] * up.per_density;
  if (layers_.product)
    for (int j = 0; j < count_; ++j) power[j] *= std::exp(-layers_.tau[j] / (arrived * travel.z));
}

// Between film and base until the walk ends. `visit` has: kIsCamera; leg(flight), of every straight leg;
// meet(depth, travel, power) before and scattered(phase, depth, travel, power) after a scattering event;
// thrown_back( travel, power) from the film; at_base(cosine, power), false to end there.
template <class Visit>
void Stack::walk_below(Vec3 travel, Powers& power, Rng& rng, Visit& visit) const {
  const Slab& slab = stack_.slab;
  const double least = kFaint * total(power);
  double depth = 0;
  for (;;) {
    const double cosine = std::max(std::abs(travel.z), 1e-12);
    const double to_border = (travel.z < 0 ? 1 - depth : depth) / cosine;
    const double free_path = slab.scatters() ? slab.sample_free_path(rng) : to_border;
    const double length = std::min(free_path, to_border);
    attenuate(length, power);
    visit.leg(slab.flight(length * cosine, cosine));
    if (free_path < to_border) {
      depth = std::clamp(depth - length * travel.z, 0.0, 1.0);
      visit.meet(depth, travel, power);
      const Vec3 next = slab.sample_phase(travel, rng);
      const double phase = slab.phase(dot(travel, next));
      travel = next;
      visit.scattered(phase, depth, travel, power);
    } else if (travel.z < 0) {
      depth = 1;
      if (!visit.at_base(cosine, power)) return;
      leave_base(power, cosine, travel, rng);
    } else {
      depth = 0;
      if (!reflect_below(travel, Visit::kIsCamera, power, rng)) return;
      visit.thrown_back(travel, power);
    }
    if (!survives(power, count_, total(power), least, rng)) return;
  }
}

// From outside along w to below the film; on_passing as in wander().
template <class OnPassing>
bool Stack::enter(const Vec3& w, bool is_camera, Powers& power, Vec3& travel, Rng& rng,
                  OnPassing on_passing) const {
  if (!stack_.multiple) return pass_once(w, is_camera, power, travel, rng);
  std::fill_n(power.begin(), count_, 1.0);
  travel = -w;
  Place at = stack_.facets.first_facet(Side::outside, -w, rng);
  at.is_entry = !is_camera;
  return wander(at, power, travel, rng, on_passing);
}

void Stack::draw_exit(const Vec3& wo, Exit& exit, Rng& rng) const {
  exit.wo = wo;
  exit.rays = 0;
  exit.is_open = enter(wo, true, exit.power, exit.up, rng, [&](const Place& beyond, const Powers& power) {
    if (exit.rays == kMostRays || (exit.rays + 1) * count_ > kRoom) return;
    const Vec3& x = beyond.travel;
    exit.ray[exit.rays] = {beyond.side, x.x, x.y, x.z, beyond.depth};
    std::copy_n(power.data(), count_, &exit.ray_power[exit.rays++ * count_]);
  });
  exit.up = -exit.up;
}

// What the facets part needs of an exit.
void Stack::draw_rays(const Vec3& wo, Exit& exit, Rng& rng) const {
  exit.wo = wo;
  exit.rays = 0;
  if (!layers_.straight) draw_exit(wo, exit, rng);
}

// The light's way in, to its first arrival below; and, apart from it, the facets part of all exits.
bool Stack::draw_entry(const Vec3& wi, const Exit* exits, int count, Powers& power, Vec3& travel, Rng& rng,
                       double* sums) const {
  if (stack_.multiple) add_facets(wi, exits, count, rng, sums);
  return enter(wi, false, power, travel, rng, [](const Place&, const Powers&) {});
}

// Facets part: the facet that light is about to meet mirrors it towards an exit or lets it pass there.
void Stack::connect_facet(const FacetPath& path, const Exit& exit, double* sums) const {
  const Place& at = path.at;
  if (at.side == Side::outside && path.order > 0) mirror_towards(path, exit.wo, 0, nullptr, sums);
  for (int k = 0; k < exit.rays; ++k) {
    const Place ray = exit.place(k);
    if (ray.side == at.side) mirror_towards(path, -ray.travel, ray.depth, &exit.ray_power[k * count_], sums);
  }
  if (at.side == Side::inside && path.only_passed && layers_.bends) pass_towards(path, exit.wo, sums);
}

// By a facet at `at` along y to what lies at the depth `origin`, without the reflectance, 1/sr.
Stack::Meeting Stack::meet_exit(const Place& at, const Vec3& y, double origin) const {
  const double visible = visibility(stack_.facets, y, at.depth, origin);
  if (visible == 0) return {0, 0};
  const Vec3 h = normalize(y - at.travel);
  if (h.z <= 0) return {0, 0};
  return {stack_.facets.mirror_density(at.travel, h) * visible / std::abs(y.z), dot(y, h)};
}

// What carries `beyond` (null: 1) is at the depth `origin`.
void Stack::mirror_towards(const FacetPath& path, const Vec3& y, double origin, const double* beyond,
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
void Stack::pass_towards(const FacetPath& path, const Vec3& wo, double* sums) const {
  const Place& at = path.at;
  const double ratio = 1 / layers_.index_ratio;
  Vec3 h = wo + ratio * at.travel;
  if (h.z < 0) h = -h;
  h = normalize(h);
  if (dot(at.travel, h) >= 0 || dot(wo, h) <= 0) return;
  const double visible = visibility(stack_.facets, wo, depth_from_other_side(at.depth), 0);
  Powers r;
  reflectances(at, -dot(at.travel, h), r);
  const double factor = stack_.facets.passing_density(at.travel, h, wo, ratio) * visible *
                        (chance_ ? 1 : 0.5) / (wo.z * kWalks);
  for (int j = 0; j < count_; ++j) sums[j] += path.power[j] * (1 - r[j]) * factor;
}

// Slab part: light that scatters at `depth`, towards what lies at the depth `origin` against y and carries
// `beyond`. `others` is the sum of 1 / (phase flight) over the events where the path could have been
// connected instead: the balance heuristic, for a technique leaves exactly these two densities out.
void Stack::scatter_towards(double depth, const Vec3& travel, const Powers& power, const Vec3& y,
                            double origin, const Powers& beyond, double others, double* sums) const {
  const double distance = y.z > 0 ? depth - origin : origin - depth, cosine = std::abs(y.z);
  if (!(distance > 0) || cosine < 1e-12) return;
  const double density = stack_.slab.phase(dot(travel, y)) * stack_.slab.flight(distance, cosine);
  if (density == 0) return;
  Powers value;
  for (int j = 0; j < count_; ++j) value[j] = power[j] * beyond[j];
  attenuate(distance / cosine, value);
  const double factor = layers_.radiance_scale * density / (1 + density * others) / kWalks;
  for (int j = 0; j < count_; ++j) sums[j] += value[j] * factor;
}

// Base part: what the base makes of light that arrives and of what the camera sees of it, `walks` pairs in
// all.
void Stack::add_base(const Powers& light, const Powers& camera, double walks, double* sums) const {
  for (int j = 0; j < count_; ++j)
    sums[j] +=
        light[j] * camera[j] * (chance_ ? 1 : layers_.albedo[j]) * kInvPi * layers_.radiance_scale / walks;
}

// The light's walk below the film, seen by exits that nothing scatters on.
struct Stack::LightVisit {
  static constexpr bool kIsCamera = false;
  const Stack& stack;
  const Exit* exits;
  int count;
  double* sums;
  Powers arrived{};  // at the base, all visits

  void leg(double) {}
  void meet(double depth, const Vec3& travel, const Powers& power) {
    for (int k = 0; k < count; ++k)
      if (exits[k].is_open)
        stack.scatter_towards(depth, travel, power, exits[k].up, 0, exits[k].power, 0,
                              sums + k * stack.count_);
  }
  void scattered(double, double, const Vec3&, const Powers&) {}
  void thrown_back(const Vec3&, const Powers&) {}
  bool at_base(double cosine, const Powers& power) {
    for (int j = 0; j < stack.count_; ++j) arrived[j] += power[j];
    if (stack.layers_.product && !stack.chance_)
      for (int k = 0; k < count; ++k) connect_product(cosine, power, exits[k], sums + k * stack.count_);
    return true;
  }
  void connect_product(double cosine, const Powers& power, const Exit& exit, double* sum) const {
    if (!exit.is_open) return;
    Powers value;
    for (int j = 0; j < stack.count_; ++j)
      value[j] = power[j] * std::exp(-stack.layers_.tau[j] / (cosine * exit.up.z));
    stack.add_base(value, exit.power, kWalks, sum);
  }
};

void Stack::add_unidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const {
  Powers light{}, leaving[kMostExits]{};  // sums over walks, for the base part
  for (int walk = 0; walk < kWalks; ++walk) {
    Exit exit[kMostExits];
    for (int k = 0; k < exits; ++k) {
      draw_exit(wo[k], exit[k], rng);
      if (!exit[k].is_open) continue;
      Powers ballistic = exit[k].power;
      attenuate(1 / exit[k].up.z, ballistic);
      const double unscattered = std::exp(-stack_.slab.scattering_depth / exit[k].up.z);
      for (int j = 0; j < count_; ++j) leaving[k][j] += ballistic[j] * unscattered;
    }
    Powers power;
    Vec3 travel;
    if (!draw_entry(wi, exit, exits, power, travel, rng, sums)) continue;
    LightVisit visit{*this, exit, exits, sums};
    walk_below(travel, power, rng, visit);
    for (int j = 0; j < count_; ++j) light[j] += visit.arrived[j];
  }
  if (layers_.product && !chance_) return;
  for (int k = 0; k < exits; ++k) add_base(light, leaving[k], kWalks * kWalks, sums + k * count_);
}

void Stack::add_facets(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const {
  Exit exit[kMostExits];
  for (int k = 0; k < exits; ++k) draw_rays(wo[k], exit[k], rng);
  double found[kMostExits * kMostWavelengths];
  std::fill_n(found, exits * count_, 0.0);
  add_facets(wi, exit, exits, rng, found);
  for (int i = 0; i < exits * count_; ++i) sums[i] += found[i] * kWalks;  // connections are shares of so many
}

// A ray of the camera's walk through the slab: light that reaches `origin` against it is seen.
struct Stack::CameraRay {
  double origin;
  double x, y, z;  // travel of that light
  Powers power;
  double others;  // sum of 1 / (phase flight) over the walk's scattering events
  int events;     // their number
};

struct Stack::CameraVisit {
  static constexpr bool kIsCamera = true;
  int most_events = 0;
  Powers arrived{};
  int rays = 0, events = 0;
  double others = 0, last_flight = 0;
  std::array<CameraRay, 2 * kMostCameraEvents + 1> ray;

  void add(double origin, const Vec3& travel, const Powers& power) {
    if (events <= most_events) ray[rays++] = {origin, -travel.x, -travel.y, -travel.z, power, others, events};
  }
  void leg(double flight) { last_flight = flight; }
  void meet(double, const Vec3&, const Powers&) {}
  void scattered(double phase, double depth, const Vec3& travel, const Powers& power) {
    others += 1 / (phase * last_flight);
    ++events;
    add(depth, travel, power);
  }
  void thrown_back(const Vec3& travel, const Powers& power) { add(0, travel, power); }
  bool at_base(double, const Powers& power) {
    arrived = power;
    return false;
  }
};

// Of the light's last events, the latest first: what the camera could have done in their place.
struct Stack::PairedLightVisit {
  static constexpr bool kIsCamera = false;
  const Stack& stack;
  const CameraVisit* cameras;
  int count;
  double* sums;
  Powers arrived{};
  bool has_seen_base = false;
  double last_phase = 0;                            // of the event that began this leg, else 0
  std::array<double, kMostCameraEvents> inverse{};  // 1 / (phase flight)

  void leg(double flight) {
    if (last_phase == 0) return;
    std::rotate(inverse.begin(), inverse.end() - 1, inverse.end());
    inverse.front() = 1 / (last_phase * flight);
    last_phase = 0;
  }
  void meet(double depth, const Vec3& travel, const Powers& power) {
    if (has_seen_base) return;
    std::array<double, kMostCameraEvents + 1> lately{};  // sums over the last events
    for (int e = 0; e < stack.camera_events_; ++e) lately[e + 1] = lately[e] + inverse[e];
    for (int k = 0; k < count; ++k)
      for (int r = 0; r < cameras[k].rays; ++r) {
        const CameraRay& ray = cameras[k].ray[r];
        stack.scatter_towards(depth, travel, power, {ray.x, ray.y, ray.z}, ray.origin, ray.power,
                              ray.others + lately[stack.camera_events_ - ray.events],
                              sums + k * stack.count_);
      }
  }
  void scattered(double phase, double, const Vec3&, const Powers&) { last_phase = phase; }
  void thrown_back(const Vec3&, const Powers&) {}
  bool at_base(double, const Powers& power) {
    has_seen_base = true;
    for (int j = 0; j < stack.count_; ++j) arrived[j] += power[j];
    return true;
  }
};

void Stack::add_bidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const {
  if (layers_.product) return add_unidirectional(wi, wo, exits, rng, sums);
  Powers light{}, leaving[kMostExits]{};  // sums over walks, for the base part
  for (int walk = 0; walk < kWalks; ++walk) {
    Exit exit[kMostExits];
    CameraVisit seen[kMostExits];
    for (int k = 0; k < exits; ++k) {
      draw_exit(wo[k], exit[k], rng);
      seen[k].most_events = camera_events_;
      if (!exit[k].is_open) continue;
      Powers power = exit[k].power;
      seen[k].add(0, -exit[k].up, power);
      walk_below(-exit[k].up, power, rng, seen[k]);
      for (int j = 0; j < count_; ++j) leaving[k][j] += seen[k].arrived[j];
    }
    Powers power;
    Vec3 travel;
    if (!draw_entry(wi, exit, exits, power, travel, rng, sums)) continue;
    PairedLightVisit visit{*this, seen, exits, sums};
    walk_below(travel, power, rng, visit);
    for (int j = 0; j < count_; ++j) light[j] += visit.arrived[j];
  }
  for (int k = 0; k < exits; ++k) add_base(light, leaving[k], kWalks * kWalks, sums + k * count_);
}

// One facet: true if it mirrors. `power` is multiplied by what that turn weighs.
bool Stack::choose_mirror(const Place& at, double cosine, Powers& power, double& chance, Rng& rng) const {
  Powers r;
  reflectances(at, cosine, r);
  const double mirrors = mirror_chance(at, r);
  const bool is_mirrored = rng.uniform() < mirrors;
  chance = is_mirrored ? mirrors : 1 - mirrors;
  for (int j = 0; j < count_; ++j) power[j] *= (is_mirrored ? r[j] : 1 - r[j]) / chance;
  return is_mirrored;
}

// From the first facet met at `at` until light leaves the film on either side.
void Stack::wander_freely(Place at, Powers& power, Outcome& out, Rng& rng) const {
  const Microsurface& facets = stack_.facets;
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
Stack::Outcome Stack::meet_film(Side side, const Vec3& x, bool is_entry, Powers& power, Rng& rng) const {
  Outcome out;
  if (stack_.multiple) {
    Place at = stack_.facets.first_facet(side, x, rng);
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
Vec3 Stack::return_to_film(Vec3 travel, Powers& power, Rng& rng) const {
  const Slab& slab = stack_.slab;
  double depth = 0, arrived = 1;
  for (;;) {
    const double cosine = std::max(std::abs(travel.z), 1e-12);
    const double to_border = (travel.z < 0 ? 1 - depth : depth) / cosine;
    const double free_path = slab.scatters() ? slab.sample_free_path(rng) : to_border;
    attenuate(std::min(free_path, to_border), power);
    if (free_path < to_border) {
      depth = std::clamp(depth - free_path * travel.z, 0.0, 1.0);
      travel = slab.sample_phase(travel, rng);
      continue;
    }
    if (travel.z > 0) return travel;
    depth = 1;
    arrived = cosine;
    travel = sample_cosine({rng.uniform(), rng.uniform()});
    for (int j = 0; j < count_; ++j) power[j] *= layers_.albedo[j];
    if (layers_.product)
      for (int j = 0; j < count_; ++j) power[j] *= std::exp(-layers_.tau[j] / (arrived * travel.z));
  }
}

StackSample Stack::sample(const Vec3& wo, Powers& power, Rng& rng) const {
  for (int j = 0; j < count_; ++j) power[j] = 1;
  Outcome film = meet_film(Side::outside, -wo, true, power, rng);
  StackSample result;
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
