// The encodings of a table, and which materials they can hold.
#pragma once

#include "sunbeam/material.h"

namespace sunbeam {

// How a table holds the rest: sunbeam/table.h. automatic: the smallest whose measured error meets the
// recipe's tolerances.
enum class Encoding { automatic, dense, factored };

constexpr const char* name_of(Encoding encoding) {
  constexpr const char* kNames[] = {"auto", "dense", "factored"};
  return kNames[static_cast<int>(encoding)];
}

// True if the factored encoding can hold it: single facets, no scattering.
inline bool has_factors(const Material& material) {
  return !material.scatters() && !material.has_multiple_facets();
}

// True if adding and doubling solves it (live/adding_doubling/slab_solver.h).
bool has_solution(const Material& material);

}  // namespace sunbeam
