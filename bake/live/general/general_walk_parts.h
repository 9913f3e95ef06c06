// What the source files of GeneralWalk share.
#pragma once

#include "bake/live/general/general_walk.h"

namespace sunbeam::walk {

// Room for the rays of an exit, in powers. Connections beyond it, to light that passes some fifty facets in a
// row at twenty wavelengths, are left out. Estimates are unbiased but for that.
inline constexpr int kRoom = 1024, kMostRays = 128;

// A walk that has lost all but this of its power goes on by roulette.
inline constexpr double kFaint = 0.15;

inline void scale(Powers& power, int count, double factor) {
  for (int j = 0; j < count; ++j) power[j] *= factor;
}

// Keeps `power` at `least` in the mean by ending walks below it. False if this one ends.
inline bool survives(Powers& power, int count, double total, double least, Rng& rng) {
  if (total >= least) return true;
  if (!(rng.uniform() * least < total)) return false;
  scale(power, count, least / total);
  return true;
}

// A straight leg of a walk between film and base, to the next scattering event or to either border.
struct Leg {
  double cosine;  // of its travel with the normal, without sign
  double length;
  bool scatters;
};
inline Leg next_leg(const Slab& slab, double depth, const Vec3& travel, Rng& rng) {
  const double cosine = std::max(std::abs(travel.z), 1e-12);
  const double to_border = (travel.z < 0 ? 1 - depth : depth) / cosine;
  const double free_path = slab.scatters() ? slab.sample_free_path(rng) : to_border;
  return {cosine, std::min(free_path, to_border), free_path < to_border};
}
// Where the leg ends, if it scatters.
inline double depth_after(const Leg& leg, double depth, const Vec3& travel) {
  return std::clamp(depth - leg.length * travel.z, 0.0, 1.0);
}

// A direction drawn backwards from an exit to below the film.
struct GeneralWalk::Exit {
  Vec3 wo;
  bool is_open;
  Vec3 up;  // travel of light that takes this exit
  Powers power;
  // On its way, after each facet passed as long as none has mirrored.
  int rays;
  std::array<Place, kMostRays> ray;
  std::array<double, kRoom> ray_power;  // count_ of the walk for each
};

// A ray of the camera's walk through the slab: light that reaches `origin` against it is seen.
struct GeneralWalk::CameraRay {
  double origin;
  Vec3 travel;  // of that light
  Powers power;
  double others;  // sum of 1 / (phase flight) over the walk's scattering events
  int events;     // their number
};

struct GeneralWalk::CameraVisit {
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

// The rooms that an estimate draws its paths in: they are too large for the stack of a thread.
struct GeneralWalk::Workspace {
  std::array<Exit, kMostExits> exit;
  std::array<CameraVisit, kMostExits> seen;
  Exit entry;  // of the facets part
};

}  // namespace sunbeam::walk
