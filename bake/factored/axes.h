// Axes of the factored encoding's arrays (sunbeam/detail/factors.h), as the recipe's grid, wavelengths and
// film ask for.
#pragma once

#include "bake/recipe/recipe.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {

// Factors without the values of their arrays; members as there.
struct FactorShapes {
  std::vector<Axis> grid;
  Wavelengths wavelengths;
  ArrayShape arrival, returned, exchange;
};

// Throws Error if the recipe's factored table would be larger than a machine can hold.
FactorShapes factor_shapes(const Recipe& recipe);

// Directions (cos_theta, phi) of an array of the recipe; `suffix` tells two of them apart.
std::vector<Axis> direction_axes(const Recipe& recipe, const std::string& suffix);

}  // namespace sunbeam
