// This file refuses recipes whose rest has lobes too narrow for the directions of a dense table. Between its
// nodes such a lobe would be as wide as their distance, and the table would return more light than arrives.
#pragma once

#include "bake/recipe/recipe.h"

namespace sunbeam {

// Throws Error naming the key if facets met more than once, or the pigment's phase function, have such lobes.
// What is little too narrow passes: it is for the check at the end of a bake.
void require_wide_lobes(const Recipe& recipe);

}  // namespace sunbeam
