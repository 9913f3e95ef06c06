#include "bake/live/general/general_walk.h"

#include "bake/live/general/general_walk_parts.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam::walk {

GeneralWalk::GeneralWalk(const Layers& layers, const GeneralLayers& general, const double* importance,
                         const Kernels& kernels, Carrying carrying)
    : layers_(layers),
      general_(general),
      importance_(importance),
      kernels_(kernels),
      chance_(carrying == Carrying::chance),
      count_(chance_ ? 1 : layers.count),
      camera_events_(
          std::min(2 + static_cast<int>(general.slab.g / (1 - general.slab.g)), kMostCameraEvents)) {}

// One for each thread, since threads share a const GeneralWalk. One serves all walks of a thread: an estimate
// draws what it reads, and no estimate runs within another. It starts as zeros, so that a thread pays for the
// pages that it touches and no call allocates.
GeneralWalk::Workspace& GeneralWalk::workspace() {
  static constinit thread_local Workspace rooms{};
  return rooms;
}

double GeneralWalk::total(const Powers& power) const {
  double sum = 0;
  for (int j = 0; j < count_; ++j) sum += power[j];
  return sum;
}

// How often sample() takes a facet to mirror.
double GeneralWalk::mirror_chance(const Place& at, const Powers& r) const {
  double mean = 0;
  for (int j = 0; j < layers_.count; ++j) mean += importance_[j] * r[j];
  mean = std::clamp(mean, 0.0, 1.0);
  return at.is_entry ? layers_.entry_chance(mean) : mean;
}

void GeneralWalk::reflectances(const Place& at, double cosine, Powers& r) const {
  const FilmSide& film = at.side == Side::outside ? layers_.film : layers_.film_below;
  kernels_.reflectances(film, layers_.phases, std::clamp(cosine, 0.0, 1.0), r.data());
  if (chance_) r[0] = mirror_chance(at, r);
}

void GeneralWalk::attenuate(double length, Powers& power) const {
  if (chance_ || layers_.product) return;
  if (layers_.same_tau) {
    if (layers_.least_tau > 0) scale(power, count_, std::exp(-layers_.least_tau * length));
    return;
  }
  kernels_.attenuate(layers_.tau.data(), length, count_, power.data());
}

// Up from the base, which light reached at the cosine `arrived`.
void GeneralWalk::leave_base(Powers& power, double arrived, Vec3& travel, Rng& rng) const {
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
void GeneralWalk::walk_below(Vec3 travel, Powers& power, Rng& rng, Visit& visit) const {
  const Slab& slab = general_.slab;
  const double least = kFaint * total(power);
  double depth = 0;
  for (;;) {
    const Leg leg = next_leg(slab, depth, travel, rng);
    attenuate(leg.length, power);
    visit.leg(slab.flight(leg.length * leg.cosine, leg.cosine));
    if (leg.scatters) {
      depth = depth_after(leg, depth, travel);
      visit.meet(depth, travel, power);
      const Vec3 next = slab.sample_phase(travel, rng);
      const double phase = slab.phase(dot(travel, next));
      travel = next;
      visit.scattered(phase, depth, travel, power);
    } else if (travel.z < 0) {
      depth = 1;
      if (!visit.at_base(leg.cosine, power)) return;
      leave_base(power, leg.cosine, travel, rng);
    } else {
      depth = 0;
      if (!reflect_below(travel, Visit::kIsCamera, power, rng)) return;
      visit.thrown_back(travel, power);
    }
    if (!survives(power, count_, total(power), least, rng)) return;
  }
}

// Slab part: light that scatters at `depth`, towards what lies at the depth `origin` against y and carries
// `beyond`. `others` is the sum of 1 / (phase flight) over the events where the path could have been
// connected instead: the balance heuristic, for a technique leaves exactly these two densities out.
void GeneralWalk::scatter_towards(double depth, const Vec3& travel, const Powers& power, const Vec3& y,
                                  double origin, const Powers& beyond, double others, double* sums) const {
  const double distance = y.z > 0 ? depth - origin : origin - depth, cosine = std::abs(y.z);
  if (!(distance > 0) || cosine < 1e-12) return;
  const double density = general_.slab.phase(dot(travel, y)) * general_.slab.flight(distance, cosine);
  if (density == 0) return;
  Powers value;
  for (int j = 0; j < count_; ++j) value[j] = power[j] * beyond[j];
  attenuate(distance / cosine, value);
  const double factor = layers_.radiance_scale * density / (1 + density * others) / kWalks;
  for (int j = 0; j < count_; ++j) sums[j] += value[j] * factor;
}

// Base part: what the base makes of light that arrives and of what the camera sees of it, `walks` pairs in
// all.
void GeneralWalk::add_base(const Powers& light, const Powers& camera, double walks, double* sums) const {
  for (int j = 0; j < count_; ++j)
    sums[j] +=
        light[j] * camera[j] * (chance_ ? 1 : layers_.albedo[j]) * kInvPi * layers_.radiance_scale / walks;
}

// The light's walk below the film, seen by exits that nothing scatters on.
struct GeneralWalk::LightVisit {
  static constexpr bool kIsCamera = false;
  const GeneralWalk& walk;
  const Exit* exits;
  int count;
  double* sums;
  Powers arrived{};  // at the base, all visits

  void leg(double) {}
  void meet(double depth, const Vec3& travel, const Powers& power) {
    for (int k = 0; k < count; ++k)
      if (exits[k].is_open)
        walk.scatter_towards(depth, travel, power, exits[k].up, 0, exits[k].power, 0, sums + k * walk.count_);
  }
  void scattered(double, double, const Vec3&, const Powers&) {}
  void thrown_back(const Vec3&, const Powers&) {}
  bool at_base(double cosine, const Powers& power) {
    for (int j = 0; j < walk.count_; ++j) arrived[j] += power[j];
    if (walk.layers_.product && !walk.chance_)
      for (int k = 0; k < count; ++k) connect_product(cosine, power, exits[k], sums + k * walk.count_);
    return true;
  }
  void connect_product(double cosine, const Powers& power, const Exit& exit, double* sum) const {
    if (!exit.is_open) return;
    Powers value;
    for (int j = 0; j < walk.count_; ++j)
      value[j] = power[j] * std::exp(-walk.layers_.tau[j] / (cosine * exit.up.z));
    walk.add_base(value, exit.power, kWalks, sum);
  }
};

void GeneralWalk::add_unidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng,
                                     double* sums) const {
  Powers light{}, leaving[kMostExits]{};  // sums over walks, for the base part
  Exit* exit = workspace().exit.data();
  for (int walk = 0; walk < kWalks; ++walk) {
    for (int k = 0; k < exits; ++k) {
      draw_exit(wo[k], exit[k], rng);
      if (!exit[k].is_open) continue;
      Powers ballistic = exit[k].power;
      attenuate(1 / exit[k].up.z, ballistic);
      const double unscattered = std::exp(-general_.slab.scattering_depth / exit[k].up.z);
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

// Of the light's last events, the latest first: what the camera could have done in their place.
struct GeneralWalk::PairedLightVisit {
  static constexpr bool kIsCamera = false;
  const GeneralWalk& walk;
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
    for (int e = 0; e < walk.camera_events_; ++e) lately[e + 1] = lately[e] + inverse[e];
    for (int k = 0; k < count; ++k)
      for (int r = 0; r < cameras[k].rays; ++r) {
        const CameraRay& ray = cameras[k].ray[r];
        walk.scatter_towards(depth, travel, power, ray.travel, ray.origin, ray.power,
                             ray.others + lately[walk.camera_events_ - ray.events], sums + k * walk.count_);
      }
  }
  void scattered(double phase, double, const Vec3&, const Powers&) { last_phase = phase; }
  void thrown_back(const Vec3&, const Powers&) {}
  bool at_base(double, const Powers& power) {
    has_seen_base = true;
    for (int j = 0; j < walk.count_; ++j) arrived[j] += power[j];
    return true;
  }
};

void GeneralWalk::add_bidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const {
  if (layers_.product) return add_unidirectional(wi, wo, exits, rng, sums);
  Powers light{}, leaving[kMostExits]{};  // sums over walks, for the base part
  Exit* exit = workspace().exit.data();
  CameraVisit* seen = workspace().seen.data();
  for (int walk = 0; walk < kWalks; ++walk) {
    for (int k = 0; k < exits; ++k) {
      draw_exit(wo[k], exit[k], rng);
      seen[k].start(camera_events_);
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

}  // namespace sunbeam::walk
