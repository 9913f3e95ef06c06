// `arrival` of the factored encoding (sunbeam/detail/factors.h): how much of the light along a direction
// reaches the base of a rough film, at all optical depths and fringe orders. Legs grow ever finer until
// independent replicates agree to the recipe's accuracy.noise.
#pragma once

#include "bake/blocks/job.h"
#include "bake/factored/factored_bake.h"

namespace sunbeam {

// The mean relative variance of A, then log A less its decay, at (depth, order).
Block walk_arrival(const FactoredBake& bake, std::size_t ior, std::size_t direction);

// Puts the values of such a block into `array`; returns the mean relative variance.
double add_arrival(std::size_t ior, std::size_t direction, const std::string& bytes, NdArray& array);

}  // namespace sunbeam
