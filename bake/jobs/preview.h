// A coarse table of the same material in seconds.
#pragma once

#include "bake/recipe/recipe.h"

namespace sunbeam {

// The recipe with fewer nodes and more noise.
Recipe preview_of(const Recipe& recipe);

}  // namespace sunbeam
