// This file chooses the axes of the factored encoding's arrays (sunbeam/detail/factors.h), as the recipe's
// grid, wavelengths and film ask for.
#pragma once

#include "bake/recipe/recipe.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {

// Holds Factors without the values of their arrays; the members are those described there.
struct FactorShapes {
  std::vector<Axis> grid;
  Wavelengths wavelengths;
  ArrayShape arrival, returned, exchange;
  ArrayShape facet_cosine{}, crossing{}, return_cosine{}, returning{};  // of a layered film
};

// Returns the number of the axis of fringe orders of `exchange`, which two directions follow.
inline std::size_t order_axis(const ArrayShape& exchange) { return exchange.axes().size() - 5; }

// Says whether the recipe's optical depths are within what a factored table holds.
bool has_factored_depths(const Recipe& recipe);

// Returns the shapes of the recipe's factored table. Throws Error if it would be larger than a computer can
// hold, or if its optical depths are too large.
FactorShapes factor_shapes(const Recipe& recipe);

// Returns the axes of a direction (cos_theta, phi) in an array of the recipe. `suffix` tells the two
// directions of one array apart.
std::vector<Axis> direction_axes(const Recipe& recipe, const std::string& suffix);

}  // namespace sunbeam
