// Makes the arrays `return_cosine` and `returning` of a layered film's table, which sunbeam/detail/factors.h
// stores and runtime/src/layers/layered_waves.h looks up: how light that leaves the base meets facets from
// below, and how much of it comes back if they mirror it.
#pragma once

#include <span>
#include <vector>

#include "sunbeam/material.h"

namespace sunbeam {

struct Returning {
  std::vector<double> cosines;  // of each rank (sunbeam/detail/factors.h)
  std::vector<double> values;   // at (optical depth, rank), 0 to 1
};

Returning returning_of(const Material& material, std::span<const double> ranks,
                       std::span<const double> depths);

}  // namespace sunbeam
