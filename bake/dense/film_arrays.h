// This file makes the closed-form part of a table. It is the film's reflectance and, for a rough or layered
// film, its mean transmittance; in spectrum "full" also the base on its own.
#pragma once

#include "bake/recipe/recipe.h"
#include "sunbeam/table.h"

namespace sunbeam {

// Fills table.film_reflectance, table.film_transmittance and table.first_visit for the recipe's grid.
void bake_film(const Recipe& recipe, Table& table);

}  // namespace sunbeam
