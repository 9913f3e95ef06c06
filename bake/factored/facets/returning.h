// Makes the arrays `return_cosine` and `returning` of a layered film's table, which sunbeam/detail/factors.h
// stores and runtime/src/layers/layered_waves.h looks up: how light that leaves the base meets facets from
// below, and how much of it comes back if they mirror it.
#pragma once

#include <span>
#include <vector>

#include "sunbeam/material.h"

namespace sunbeam {

struct Returning {
  std::vector<double> cosines;  // of each share v: v of the facets are met at a lower cosine
  std::vector<double> values;   // at (optical depth, share), 0 to 1
};

Returning returning_of(const Material& material, std::span<const double> shares,
                       std::span<const double> depths);

}  // namespace sunbeam
