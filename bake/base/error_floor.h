// This file sets the floor of relative errors: what is darker need not be known better.
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {

// Below this albedo errors count as if it were this: the floor of verify's denominators. Values darker than
// its Lambertian value (1/sr) need no better absolute noise than at it.
inline constexpr double kDarkestAlbedo = 0.002;
inline constexpr double kDarkestValue = kDarkestAlbedo * kInvPi;

// Returns the mean of the components' magnitudes; folded colours may have negative ones.
inline double mean_abs(const Rgb& a) {
  return mean(transform(a, [](double x) { return std::abs(x); }));
}

}  // namespace sunbeam
