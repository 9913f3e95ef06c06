// This file names the encodings of a table and says which materials they can hold.
#pragma once

#include "sunbeam/material.h"

namespace sunbeam {

// Says how a table holds the rest (sunbeam/table.h). `automatic` takes the smallest encoding whose measured
// error meets the recipe's tolerances, or the best if none does.
enum class Encoding { automatic, dense, factored };

constexpr const char* name_of(Encoding encoding) {
  constexpr const char* kNames[] = {"auto", "dense", "factored"};
  return kNames[static_cast<int>(encoding)];
}

// Says whether the factored encoding can hold the material: single facets, no scattering.
inline bool has_factors(const Material& material) {
  return !material.scatters() && !material.has_multiple_facets();
}

// Says whether adding and doubling solves the material (live/adding_doubling/slab_solver.h).
bool has_solution(const Material& material);

}  // namespace sunbeam
