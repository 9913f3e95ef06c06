// Bakes a recipe: PFMC at every node of (film thickness, base IOR, absorption) x directions, in parallel.
#pragma once

#include <cstdint>
#include <functional>

#include "bake/estimator.h"
#include "bake/recipe.h"
#include "sunbeam/table.h"

namespace sunbeam {

struct SweepSettings {
  std::uint64_t seed = 1;
  int threads = 0;                                   // 0: all
  std::function<void(double fraction)> on_progress;  // called now and then, one thread at a time
};

// What the recipe asks for, or what can hold its material, the smallest in memory first.
std::vector<Encoding> encodings_of(const Recipe& recipe);

// How the nodes of a dense table are found: its attribute `estimator`.
const char* dense_method(const Recipe& recipe);

// Throws Error if the table would be larger than a machine can be expected to hold.
void require_reasonable_size(const Recipe& recipe, Encoding encoding);

// The same recipe and seed give the same bits for every thread count. Dense: each (parameter node, wi) has
// its own random stream and its own stop rule; factored: see factor_walks.h. info holds everything but the
// measured error.
Table bake_table(const Recipe& recipe, Encoding encoding, const SweepSettings& settings);
// In the first of encodings_of().
Table bake_table(const Recipe& recipe, const SweepSettings& settings);

}  // namespace sunbeam
