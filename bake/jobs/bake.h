// Bakes a recipe: which encodings may hold it, the job that makes one, and all of it in memory at once.
#pragma once

#include <cstdint>
#include <functional>

#include "bake/blocks/job.h"
#include "bake/recipe/recipe.h"

namespace sunbeam {

// What the recipe asks for, or what can hold its material, the smallest in memory first.
std::vector<Encoding> encodings_of(const Recipe& recipe);

// Throws Error if the table would be larger than a machine can be expected to hold.
void require_reasonable_size(const Recipe& recipe, Encoding encoding);

// Of the table's arrays, uncompressed.
double bytes_of(const Recipe& recipe, Encoding encoding);

// `recipe` must outlive the job.
std::unique_ptr<BakeJob> make_job(const Recipe& recipe, Encoding encoding, std::uint64_t seed);

struct BakeSettings {
  std::uint64_t seed = 1;
  int threads = 0;                                   // 0: all
  std::function<void(double fraction)> on_progress;  // now and then, one thread at a time
};

// The same recipe and seed give the same bits for every thread count. info holds everything but the measured
// error.
Table bake_table(const Recipe& recipe, Encoding encoding, const BakeSettings& settings);
// In the first of encodings_of().
Table bake_table(const Recipe& recipe, const BakeSettings& settings);

}  // namespace sunbeam
