// Direction pairs <-> table coordinates. Map, inverse and Jacobian stand side by side.
//
// A table has four angular axes, cosines and azimuths (radians): (cos_theta_i, phi_i, cos_theta_o, phi_o).
// anisotropic: the azimuths of wi and wo, both in [0, 2 pi).
// isotropic:   phi_i = 0 and phi_o = |azimuth between wi and wo| in [0, pi]; pi is the mirror side.
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {

enum class Symmetry { isotropic, anisotropic };

struct AngleCoordinates {
  double cos_i, phi_i, cos_o, phi_o;
};

struct DirectionPair {
  Vec3 wo, wi;
};

// In [0, 2 pi).
inline double azimuth(const Vec3& w) {
  const double phi = std::atan2(w.y, w.x);
  if (phi >= 0) return phi;
  const double wrapped = phi + 2 * kPi;
  return wrapped < 2 * kPi ? wrapped : 0;  // a tiny negative angle would round to 2 pi
}

inline AngleCoordinates to_coordinates(Symmetry symmetry, const DirectionPair& pair) {
  const double phi_i = azimuth(pair.wi), phi_o = azimuth(pair.wo);
  if (symmetry == Symmetry::anisotropic) return {pair.wi.z, phi_i, pair.wo.z, phi_o};
  const double between = std::abs(phi_o - phi_i);
  return {pair.wi.z, 0, pair.wo.z, std::min(between, 2 * kPi - between)};
}

// A pair with these coordinates; for an isotropic table the one with wi in the xz plane and wo at +|dphi|.
inline DirectionPair to_directions(const AngleCoordinates& c) {
  return {direction_from_cosine(c.cos_o, c.phi_o), direction_from_cosine(c.cos_i, c.phi_i)};
}

// Measure of direction pairs per unit of coordinates, dwi dwo / d(coordinates), in sr^2. Cosines make it
// constant; an isotropic coordinate stands for every common azimuth (2 pi) and both signs of dphi (2).
inline constexpr double pair_measure(Symmetry symmetry) {
  return symmetry == Symmetry::anisotropic ? 1 : 4 * kPi;
}

}  // namespace sunbeam
