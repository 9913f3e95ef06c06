// This file states the mean of independent estimates by walks, and its standard error.
#pragma once

#include <cstdint>

#include "bake/base/running_mean.h"

namespace sunbeam {

// Walks state no error below this, in 1/sr and of albedos. What is darker lies behind so much pigment or so
// far out in the facets' distribution that the walks which make it up may all be missing.
inline constexpr double kLeastWalkedError = 1e-9;

struct WalkedMean {
  Rgb value, standard_error;
};

// Calls estimate() so many times, at least twice.
template <class Once>
WalkedMean walked_mean(std::int64_t estimates, Once estimate) {
  RunningMean cell;
  for (std::int64_t k = 0; k < estimates; ++k) cell.add(estimate());
  const auto count = static_cast<double>(estimates);
  const auto floored = [](double error) { return std::max(error, kLeastWalkedError); };
  return {cell.mean_of(count), transform(cell.standard_error(count), floored)};
}

}  // namespace sunbeam
