// This file bakes a recipe: it says which encodings may hold it, makes the job for one of them, or bakes a
// whole table in memory.
#pragma once

#include <cstdint>
#include <functional>

#include "bake/blocks/job.h"
#include "bake/recipe/recipe.h"

namespace sunbeam {

// Returns the encoding that the recipe asks for, or those that can hold its material, the smallest in memory
// first.
std::vector<Encoding> encodings_of(const Recipe& recipe);

// Throws Error if the table would be larger than a computer can be expected to hold.
void require_reasonable_size(const Recipe& recipe, Encoding encoding);

// Returns the bytes of the table's arrays, uncompressed.
double bytes_of(const Recipe& recipe, Encoding encoding);

// Makes the job, which `recipe` must outlive. Throws Error if no table can hold the recipe's film yet.
std::unique_ptr<BakeJob> make_job(const Recipe& recipe, Encoding encoding, std::uint64_t seed);

struct BakeSettings {
  std::uint64_t seed = 1;
  int threads = 0;                                   // 0: all
  std::function<void(double fraction)> on_progress;  // now and then, one thread at a time
};

// Bakes a table in the given encoding. The same recipe and seed give the same bits for every thread count.
// info holds everything but the measured error.
Table bake_table(const Recipe& recipe, Encoding encoding, const BakeSettings& settings);
// Bakes a table in the first of encodings_of().
Table bake_table(const Recipe& recipe, const BakeSettings& settings);

}  // namespace sunbeam
