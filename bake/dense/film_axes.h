// This file chooses the axes of a dense table's film arrays.
#pragma once

#include <vector>

#include "bake/recipe/recipe.h"

namespace sunbeam {

// Returns the axes (film_thickness_nm, base_ior, cos_theta) of the film arrays. They are finer than the grid,
// as fringes need. Those of a layered film are as fine as its reflectance between the nodes asks for, as far
// as an array stays below 16 MB.
std::vector<Axis> film_axes(const Recipe& recipe);

}  // namespace sunbeam
