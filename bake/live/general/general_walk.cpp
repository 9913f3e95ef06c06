#include "bake/live/general/general_walk.h"

#include "bake/live/general/exit_guide.h"
#include "bake/live/general/facets_part.h"
#include "bake/live/general/film_crossing.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam::walk {
namespace {

// Scattering events of the bidirectional camera walk that connect: as many as it takes light to turn round.
constexpr int kMostCameraEvents = 16;

int camera_events(const Slab& slab) {
  return std::min(2 + static_cast<int>(slab.g / (1 - slab.g)), kMostCameraEvents);
}

// Light below the film that is about to go on, and what roulette keeps of it.
struct BelowFilm {
  double depth;
  Vec3 travel;
  Powers& power;
  double least;
  int splits = 0;  // that have led to it
};

// Walks of more splits than these are not split on.
constexpr int kMostSplits = 6;

// Up from the base, which light reached at the cosine `arrived`.
void draw_from_base(const WalkContext& walk, Powers& power, double arrived, Vec3& travel, Rng& rng) {
  if (walk.is_chance) {
    travel = sample_cosine({rng.uniform(), rng.uniform()});
    return;
  }
  const auto up = walk.layers.guide.sample(rng.uniform());
  travel = direction_from_cosine(std::sqrt(up.square), 2 * kPi * rng.uniform());
  for (int j = 0; j < walk.count; ++j) power[j] *= walk.layers.albedo[j] * up.per_density;
  if (walk.layers.product)
    for (int j = 0; j < walk.count; ++j) power[j] *= std::exp(-walk.layers.tau[j] / (arrived * travel.z));
}

template <class Visit>
void follow(const WalkContext& walk, const ExitGuide& guide, BelowFilm& light, Rng& rng, Visit& visit);

// Splits light that has left an event along `light.travel`. `wanted` gives what the event sends along a
// travel, `natural` the density with which it draws it; `before` is the power that reached it.
template <class Wanted, class Natural, class Visit>
void split(const WalkContext& walk, const ExitGuide& guide, const Powers& before, BelowFilm& light,
           Wanted wanted, Natural natural, Rng& rng, Visit& visit) {
  const auto weigh = [&](const Vec3& travel) {
    const double value = wanted(travel);
    return value > 0 ? value / (natural(travel) + guide.density(travel)) : 0;
  };
  Powers power = before;
  BelowFilm other{light.depth, guide.sample(rng), power, light.least, light.splits + 1};
  walk.scale(power, weigh(other.travel));
  light.power = before;
  walk.scale(light.power, weigh(light.travel));
  if (walk.survives(power, other.least / guide.worth(other.travel), rng))
    follow(walk, guide, other, rng, visit);
}

// Lets light scatter where it is.
template <class Visit>
void scatter(const WalkContext& walk, const ExitGuide& guide, BelowFilm& light, Rng& rng, Visit& visit) {
  const Slab& slab = walk.general.slab;
  visit.meet(light.depth, light.travel, light.power);
  const Vec3 before = light.travel;
  const auto phase = [&](const Vec3& next) { return slab.phase(dot(before, next)); };
  light.travel = slab.sample_phase(before, rng);
  if (guide.is_on() && light.splits < kMostSplits) {
    const Powers power = light.power;
    split(walk, guide, power, light, phase, phase, rng, visit);
  }
  visit.scattered(phase(light.travel), light.depth, light.travel, light.power);
}

// Lets the base throw light back that reached it at the cosine `arrived`. With "product" the pigment may
// spare later visits, and roulette forgives what it has taken.
template <class Visit>
void leave_base(const WalkContext& walk, const ExitGuide& guide, BelowFilm& light, double arrived, Rng& rng,
                Visit& visit) {
  const bool splits = guide.is_on() && light.splits < kMostSplits;
  Powers power;
  if (splits) power = light.power;
  draw_from_base(walk, light.power, arrived, light.travel, rng);
  if (walk.layers.product && !walk.is_chance)
    light.least *= std::exp(-walk.layers.least_tau / (arrived * light.travel.z));
  if (!splits) return;
  for (int j = 0; j < walk.count; ++j) power[j] *= walk.layers.albedo[j];
  const auto lambert = [](const Vec3& up) { return up.z * kInvPi; };
  const auto drawn = [&](const Vec3& up) { return lambert(up) * walk.layers.guide.density(square(up.z)); };
  split(walk, guide, power, light, lambert, drawn, rng, visit);
}

// Between film and base until the walk ends, with the help of `guide`. `visit` has: kIsCamera; leg(flight),
// of every straight leg; meet(depth, travel, power) before and scattered(phase, depth, travel, power) after a
// scattering event; thrown_back(travel, power) from the film; at_base(cosine, power), false to end there.
template <class Visit>
void follow(const WalkContext& walk, const ExitGuide& guide, BelowFilm& light, Rng& rng, Visit& visit) {
  const Slab& slab = walk.general.slab;
  Vec3& travel = light.travel;
  for (;;) {
    const Leg leg = next_leg(slab, light.depth, travel, rng);
    walk.attenuate(leg.length, light.power);
    visit.leg(slab.flight(leg.length * leg.cosine, leg.cosine));
    if (leg.scatters) {
      light.depth = depth_after(leg, light.depth, travel);
      scatter(walk, guide, light, rng, visit);
    } else if (travel.z < 0) {
      light.depth = 1;
      if (!visit.at_base(leg.cosine, light.power)) return;
      leave_base(walk, guide, light, leg.cosine, rng, visit);
    } else {
      light.depth = 0;
      if (!reflect_below(walk, travel, Visit::kIsCamera, light.power, rng)) return;
      visit.thrown_back(travel, light.power);
    }
    if (!walk.survives(light.power, light.least / guide.worth(travel), rng)) return;
  }
}

// The same from the film, where light sets out along `travel`.
template <class Visit>
void walk_below(const WalkContext& walk, const ExitGuide& guide, const Vec3& travel, Powers& power, Rng& rng,
                Visit& visit) {
  BelowFilm light{0, travel, power, kFaint * walk.total(power)};
  follow(walk, guide, light, rng, visit);
}

// Slab part: light that scatters at `depth`, towards what lies at the depth `origin` against y and carries
// `beyond`. `others` is the sum of 1 / (phase flight) over the events where the path could have been
// connected instead: the balance heuristic, for a technique leaves exactly these two densities out.
void scatter_towards(const WalkContext& walk, double depth, const Vec3& travel, const Powers& power,
                     const Vec3& y, double origin, const Powers& beyond, double others, double* sums) {
  const double distance = y.z > 0 ? depth - origin : origin - depth, cosine = std::abs(y.z);
  if (!(distance > 0) || cosine < 1e-12) return;
  const double density = walk.general.slab.phase(dot(travel, y)) * walk.general.slab.flight(distance, cosine);
  if (density == 0) return;
  Powers value;
  for (int j = 0; j < walk.count; ++j) value[j] = power[j] * beyond[j];
  walk.attenuate(distance / cosine, value);
  const double factor = walk.layers.radiance_scale * density / (1 + density * others) / kGeneralWalks;
  for (int j = 0; j < walk.count; ++j) sums[j] += value[j] * factor;
}

// Base part: what the base makes of light that arrives and of what the camera sees of it, `walks` pairs in
// all.
void add_base(const WalkContext& walk, const Powers& light, const Powers& camera, double walks,
              double* sums) {
  for (int j = 0; j < walk.count; ++j)
    sums[j] += light[j] * camera[j] * (walk.is_chance ? 1 : walk.layers.albedo[j]) * kInvPi *
               walk.layers.radiance_scale / walks;
}

// The light's walk below the film, seen by exits that nothing scatters on.
struct LightVisit {
  static constexpr bool kIsCamera = false;
  const WalkContext& walk;
  const ExitPath* exits;
  int count;
  double* sums;
  Powers arrived{};  // at the base, all visits

  void leg(double) {}
  void meet(double depth, const Vec3& travel, const Powers& power) {
    for (int k = 0; k < count; ++k)
      if (exits[k].is_open)
        scatter_towards(walk, depth, travel, power, exits[k].up, 0, exits[k].power, 0, sums + k * walk.count);
  }
  void scattered(double, double, const Vec3&, const Powers&) {}
  void thrown_back(const Vec3&, const Powers&) {}
  bool at_base(double cosine, const Powers& power) {
    for (int j = 0; j < walk.count; ++j) arrived[j] += power[j];
    if (walk.layers.product && !walk.is_chance)
      for (int k = 0; k < count; ++k) connect_product(cosine, power, exits[k], sums + k * walk.count);
    return true;
  }
  void connect_product(double cosine, const Powers& power, const ExitPath& exit, double* sum) const {
    if (!exit.is_open) return;
    Powers value;
    for (int j = 0; j < walk.count; ++j)
      value[j] = power[j] * std::exp(-walk.layers.tau[j] / (cosine * exit.up.z));
    add_base(walk, value, exit.power, kGeneralWalks, sum);
  }
};

// A ray of the camera's walk through the slab: light that reaches `origin` against it is seen.
struct CameraRay {
  double origin;
  Vec3 travel;  // of that light
  Powers power;
  double others;  // sum of 1 / (phase flight) over the walk's scattering events
  int events;     // their number
};

struct CameraVisit {
  static constexpr bool kIsCamera = true;
  int most_events;
  Powers arrived;
  int rays, events;
  double others, last_flight;
  std::array<CameraRay, 2 * kMostCameraEvents + 1> ray;

  void start(int most) {
    most_events = most;
    arrived = {};
    rays = events = 0;
    others = last_flight = 0;
  }
  void add(double origin, const Vec3& travel, const Powers& power) {
    if (events <= most_events) ray[rays++] = {origin, -travel, power, others, events};
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
struct PairedLightVisit {
  static constexpr bool kIsCamera = false;
  const WalkContext& walk;
  const CameraVisit* cameras;
  int count;
  int most_events;
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
    for (int e = 0; e < most_events; ++e) lately[e + 1] = lately[e] + inverse[e];
    for (int k = 0; k < count; ++k)
      for (int r = 0; r < cameras[k].rays; ++r) {
        const CameraRay& ray = cameras[k].ray[r];
        scatter_towards(walk, depth, travel, power, ray.travel, ray.origin, ray.power,
                        ray.others + lately[most_events - ray.events], sums + k * walk.count);
      }
  }
  void scattered(double phase, double, const Vec3&, const Powers&) { last_phase = phase; }
  void thrown_back(const Vec3&, const Powers&) {}
  bool at_base(double, const Powers& power) {
    has_seen_base = true;
    for (int j = 0; j < walk.count; ++j) arrived[j] += power[j];
    return true;
  }
};

// The rooms that an estimate draws its paths in: they are too large for the stack of a thread.
struct Workspace {
  std::array<ExitPath, GeneralWalk::kMostExits> exit;
  std::array<CameraVisit, GeneralWalk::kMostExits> seen;
  ExitPath entry;  // of the facets part
};

// One for each thread, since threads share a const GeneralWalk. One serves all walks of a thread: an estimate
// draws what it reads, and no estimate runs within another. It starts as zeros, so that a thread pays for the
// pages that it touches and no call allocates.
Workspace& workspace() {
  static constinit thread_local Workspace rooms{};
  return rooms;
}

// The light's way in, to its first arrival below; and, apart from it, the facets part of all exits.
bool draw_entry(const WalkContext& walk, const Vec3& wi, const ExitPath* exits, int count, Powers& power,
                Vec3& travel, Rng& rng, double* sums) {
  if (walk.general.multiple) add_facets_part(walk, wi, exits, count, workspace().entry, rng, sums);
  return enter(walk, wi, false, power, travel, rng, [](const Place&, const Powers&) {});
}

}  // namespace

GeneralWalk::GeneralWalk(const Layers& layers, const GeneralLayers& general, const double* importance,
                         const Kernels& kernels, Carrying carrying)
    : context_{layers,
               general,
               importance,
               kernels,
               carrying == Carrying::chance,
               carrying == Carrying::chance ? 1 : layers.count} {}

void GeneralWalk::add_unidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng,
                                     double* sums) const {
  const WalkContext& walk = context_;
  Powers light{}, leaving[kMostExits]{};  // sums over walks, for the base part
  ExitPath* exit = workspace().exit.data();
  for (int n = 0; n < kGeneralWalks; ++n) {
    for (int k = 0; k < exits; ++k) {
      draw_exit(walk, wo[k], exit[k], rng);
      if (!exit[k].is_open) continue;
      Powers ballistic = exit[k].power;
      walk.attenuate(1 / exit[k].up.z, ballistic);
      const double unscattered = std::exp(-walk.general.slab.scattering_depth / exit[k].up.z);
      for (int j = 0; j < walk.count; ++j) leaving[k][j] += ballistic[j] * unscattered;
    }
    Powers power;
    Vec3 travel;
    if (!draw_entry(walk, wi, exit, exits, power, travel, rng, sums)) continue;
    LightVisit visit{walk, exit, exits, sums};
    walk_below(walk, ExitGuide(walk.general.slab, exit, exits), travel, power, rng, visit);
    for (int j = 0; j < walk.count; ++j) light[j] += visit.arrived[j];
  }
  if (walk.layers.product && !walk.is_chance) return;
  for (int k = 0; k < exits; ++k)
    add_base(walk, light, leaving[k], kGeneralWalks * kGeneralWalks, sums + k * walk.count);
}

void GeneralWalk::add_bidirectional(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const {
  const WalkContext& walk = context_;
  if (walk.layers.product) return add_unidirectional(wi, wo, exits, rng, sums);
  Powers light{}, leaving[kMostExits]{};  // sums over walks, for the base part
  ExitPath* exit = workspace().exit.data();
  const int most_events = camera_events(walk.general.slab);
  CameraVisit* seen = workspace().seen.data();
  const ExitGuide unguided(walk.general.slab, nullptr, 0);
  for (int n = 0; n < kGeneralWalks; ++n) {
    for (int k = 0; k < exits; ++k) {
      draw_exit(walk, wo[k], exit[k], rng);
      seen[k].start(most_events);
      if (!exit[k].is_open) continue;
      Powers power = exit[k].power;
      seen[k].add(0, -exit[k].up, power);
      walk_below(walk, unguided, -exit[k].up, power, rng, seen[k]);
      for (int j = 0; j < walk.count; ++j) leaving[k][j] += seen[k].arrived[j];
    }
    Powers power;
    Vec3 travel;
    if (!draw_entry(walk, wi, exit, exits, power, travel, rng, sums)) continue;
    PairedLightVisit visit{walk, seen, exits, most_events, sums};
    walk_below(walk, unguided, travel, power, rng, visit);
    for (int j = 0; j < walk.count; ++j) light[j] += visit.arrived[j];
  }
  for (int k = 0; k < exits; ++k)
    add_base(walk, light, leaving[k], kGeneralWalks * kGeneralWalks, sums + k * walk.count);
}

void GeneralWalk::add_facets(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* sums) const {
  const WalkContext& walk = context_;
  ExitPath* exit = workspace().exit.data();
  for (int k = 0; k < exits; ++k) draw_rays(walk, wo[k], exit[k], rng);
  double found[kMostExits * kMostWavelengths];
  std::fill_n(found, exits * walk.count, 0.0);
  add_facets_part(walk, wi, exit, exits, workspace().entry, rng, found);
  for (int i = 0; i < exits * walk.count; ++i)
    sums[i] += found[i] * kGeneralWalks;  // connections are shares of so many
}

}  // namespace sunbeam::walk
