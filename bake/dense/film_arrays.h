// The closed-form part of a table: film reflectance and, for a rough film, its mean transmittance; in
// spectrum "full" also the base on its own.
#pragma once

#include "bake/recipe/recipe.h"
#include "sunbeam/table.h"

namespace sunbeam {

// Axes (film_thickness_nm, base_ior, cos_theta) of the film arrays: finer than the grid, as fringes need.
std::vector<Axis> film_axes(const Recipe& recipe);

// Fills table.film_reflectance, table.film_transmittance and table.first_visit for the recipe's grid.
void bake_film(const Recipe& recipe, Table& table);

}  // namespace sunbeam
