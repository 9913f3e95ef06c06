// This file makes recipes for a preview: a coarse table of the same material in seconds.
#pragma once

#include "bake/recipe/recipe.h"

namespace sunbeam {

// Returns the recipe with fewer nodes and more noise.
Recipe preview_of(const Recipe& recipe);

}  // namespace sunbeam
