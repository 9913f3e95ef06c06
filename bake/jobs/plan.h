// Chooses the nodes of a table before it is baked, so that what lies between them is right to
// accuracy.interpolation: the plan of a bake. It depends on the recipe and the seed alone, so every machine
// that bakes a shard makes the same one.
//
// One axis after the other, with the rest of the parameters fixed at drawn probes: the table baked on the
// axis' nodes is held against one baked on twice as many, in the middle of each interval, where interpolation
// is worst. An axis may have half of the error allowed. The random walks of both are the same, so their noise
// does not count. An interval of a parameter that misses the target is halved; of angles and azimuths there
// are half as many again until none misses. Where more nodes would break the limits, the plan stops and says
// so.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bake/recipe/recipe.h"

namespace sunbeam {

struct Plan {
  Recipe recipe;        // as it is to be baked: planned nodes, interpolation 0
  std::string summary;  // of each axis its nodes before and after, and the largest error left; one line
};

struct PlanSettings {
  std::uint64_t seed = 1;
  int threads = 0;
  std::function<void(const std::string& axis, std::size_t nodes, double error)> on_step;
};

// Nothing to do, and no axes, if the recipe has no accuracy.interpolation.
Plan plan_bake(const Recipe& recipe, const PlanSettings& settings);

// A coarse table of the same material in seconds.
Recipe preview_of(const Recipe& recipe);

}  // namespace sunbeam
