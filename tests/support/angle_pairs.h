// The inverse and the Jacobian of the coordinates of direction pairs in a table.
#pragma once

#include "sunbeam/detail/angles.h"

namespace sunbeam {

// A pair with these coordinates; for an anisotropic table the folded one, for an isotropic one that with wi
// in the xz plane and wo at +|dphi|.
inline DirectionPair to_directions(const AngleCoordinates& c) {
  return {direction_from_cosine(c.cos_o, c.phi_o), direction_from_cosine(c.cos_i, c.phi_i)};
}

// Measure of direction pairs per unit of coordinates, dwi dwo / d(coordinates), in sr^2. Cosines make it
// constant; an anisotropic coordinate stands for four mirror images, an isotropic one for every common
// azimuth (2 pi) and both signs of dphi (2).
inline constexpr double pair_measure(Symmetry symmetry) {
  return symmetry == Symmetry::anisotropic ? 4 : 4 * kPi;
}

}  // namespace sunbeam
