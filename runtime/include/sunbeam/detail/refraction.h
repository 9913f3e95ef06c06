// This file says how light bends between media and where it is reflected totally.
#pragma once

#include <algorithm>
#include <cmath>

#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// Returns the squared cosine on the far side by Snell's law; it is negative under total reflection. The
// formula is arranged so that equal media keep every digit at grazing.
inline double refracted_cosine_squared(double ior_from, double ior_to, double cos_from) {
  return ((ior_to - ior_from) * (ior_to + ior_from) + square(ior_from * cos_from)) / square(ior_to);
}

// Returns the cosine of total reflection; 0 if there is none.
inline double critical_cosine(double ior_from, double ior_to) {
  return std::sqrt(std::max(0.0, 1 - square(ior_to / ior_from)));
}

// Returns the index of the medium that light would pass into. Nothing passes into an opaque base: its
// geometry is that of a base which does not bend light.
inline double bending_base_ior(const Material& m) { return m.is_opaque() ? m.exterior_ior : m.base_ior; }

}  // namespace v1
}  // namespace sunbeam
