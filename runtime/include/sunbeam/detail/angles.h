// This file turns pairs of directions into table coordinates. The inverse and the Jacobian, which only tests
// need, are in tests/support/angle_pairs.h.
//
// A table has four angular axes, cosines and azimuths (radians): (cos_theta_i, phi_i, cos_theta_o, phi_o).
// anisotropic: the film is its own mirror image in x and in y. Both directions are mirrored such that wi has
//              x, y >= 0; then phi_i in [0, pi/2] is the azimuth of wi and phi_o in [0, 2 pi) that of wo.
// isotropic:   phi_i = 0 and phi_o = |azimuth between wi and wo| in [0, pi]; pi is the mirror side.
// The azimuth of a direction along z is arbitrary: a table holds the same values at all of them.
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

enum class Symmetry { isotropic, anisotropic };

struct AngleCoordinates {
  double cos_i, phi_i, cos_o, phi_o;
};

struct DirectionPair {
  Vec3 wo, wi;
};

// Returns the azimuth of a direction, in [0, 2 pi).
inline double azimuth(const Vec3& w) {
  const double phi = std::atan2(w.y, w.x);
  if (phi >= 0) return phi;
  const double wrapped = phi + 2 * kPi;
  return wrapped < 2 * kPi ? wrapped : 0;  // a tiny negative angle would round to 2 pi
}

// Returns the pair or its mirror image in x, y or both: the one whose wi has x, y >= 0.
inline DirectionPair folded(const DirectionPair& pair) {
  const double x = pair.wi.x < 0 ? -1 : 1, y = pair.wi.y < 0 ? -1 : 1;
  return {{x * pair.wo.x, y * pair.wo.y, pair.wo.z}, {std::abs(pair.wi.x), std::abs(pair.wi.y), pair.wi.z}};
}

inline AngleCoordinates to_coordinates(Symmetry symmetry, const DirectionPair& pair) {
  if (symmetry == Symmetry::anisotropic) {
    const DirectionPair first_quadrant = folded(pair);
    return {pair.wi.z, azimuth(first_quadrant.wi), pair.wo.z, azimuth(first_quadrant.wo)};
  }
  const double between = std::abs(azimuth(pair.wo) - azimuth(pair.wi));
  return {pair.wi.z, 0, pair.wo.z, std::min(between, 2 * kPi - between)};
}

}  // namespace v1
}  // namespace sunbeam
