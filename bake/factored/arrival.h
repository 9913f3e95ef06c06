// Makes the array `arrival` of a factored table, which sunbeam/detail/factors.h stores and
// runtime/src/fit/wave_field.h looks up: how much of the light along a direction reaches the base of a rough
// film, at all optical depths and fringe orders. Legs grow ever finer until independent replicates agree to
// the recipe's accuracy.noise.
#pragma once

#include "bake/blocks/job.h"
#include "bake/factored/shared_inputs.h"

namespace sunbeam {

// Walks the legs of one direction at one base IOR. The block holds the mean relative variance of A, then log
// A less its decay, at (depth, order).
Block walk_arrival(const SharedInputs& bake, std::size_t ior, std::size_t direction);

// Puts the values of such a block into `array`; returns the mean relative variance.
double add_arrival(std::size_t ior, std::size_t direction, const std::string& bytes, NdArray& array);

}  // namespace sunbeam
