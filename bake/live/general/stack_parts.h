// What the source files of Stack share.
#pragma once

#include "bake/live/general/stack.h"

namespace sunbeam::walk {

// Room for the rays of an exit, in powers. What passes more facets than fit, some fifty in a row at twenty
// wavelengths, is left out.
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
  std::array<double, kRoom> ray_power;  // Stack's count_ for each

  Place place(int k) const { return {ray[k].side, {ray[k].x, ray[k].y, ray[k].z}, ray[k].depth}; }
};

}  // namespace sunbeam::walk
