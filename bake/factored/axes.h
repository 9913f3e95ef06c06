// Axes of the factored encoding's arrays (sunbeam/detail/factors.h), as the recipe's grid, wavelengths and
// film ask for.
#pragma once

#include "bake/recipe/recipe.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {

// Axes of the recipe's factored table: its arrays as outlines. Throws Error if it would be larger than a
// machine can hold.
Factors factor_axes(const Recipe& recipe);

// Directions (cos_theta, phi) of an array of the recipe; `suffix` tells two of them apart.
std::vector<Axis> direction_axes(const Recipe& recipe, const std::string& suffix);

}  // namespace sunbeam
