// This file computes the Airy reflectance and transmittance of unpolarised light at one thin film between two
// half-spaces.
//
// With s = sin(theta_0), c_j the cosine in medium j, k = 2 pi n1 d / lambda and the admittances
// q_j = n_j c_j (s-polarised) or c_j / n_j (p-polarised), the amplitude of the infinite sum of reflections
//     r = (r01 + r12 e^{i phi}) / (1 + r01 r12 e^{i phi}),   phi = 2 k c_1
// multiplied out with its denominators is (A - iB) / (C - iD),
//     A, C = (q0 -+ q2) cos(k c1),   B, D = (q0 q2 / q1 -+ q1) sin(k c1).
// Written so, nothing is singular at c1 = 0 and every quantity stays real when the wave is evanescent inside
// the film (cos, sin become cosh, sinh: frustrated total reflection). Source: Born and Wolf, sec. 1.6.
// Fresnel's coefficients r_ij = (q_i - q_j) / (q_i + q_j), up to the sign of p, are never formed: without a
// film (d = 0) what is left of the fraction is r02.
//
// The powers of one polarisation follow. With b = q0 q2 c1 / q1 and d = q1 c1, and for the phase
// x = cos^2(k c1) and y = sin^2(k c1) / c1^2, which are smooth at c1 = 0,
//     R = [(q0 - q2)^2 x + (b - d)^2 y] / D,   T = 4 q0 q2 / D,   D = (q0 + q2)^2 x + (b + d)^2 y.
// In evanescent waves x and y become 1 and tanh^2 / |c1|^2, and T is divided by cosh^2. T has no
// cancellation, so both powers keep their relative precision; unpolarised light takes the mean of s and p.
// Kernels elsewhere compute the same: each says at its head which part of these equations its lanes share,
// and how precise it is.
#pragma once

#include "sunbeam/core/vec.h"
#include "sunbeam/detail/refraction.h"
#include "sunbeam/material.h"

namespace sunbeam {

struct ThinFilm {
  double exterior_ior;  // n0, of the medium the light comes from
  double film_ior;      // n1
  double base_ior;      // n2, of the medium beyond
  double thickness_nm;  // d0 >= 0

  static ThinFilm of(const Material& m) {
    return {m.exterior_ior, m.film_ior, bending_base_ior(m), m.film_thickness_nm};
  }
  // Returns the film as light below meets it; in "straight" mode it is met as from outside.
  static ThinFilm below(const Material& m) {
    return m.transmission == Transmission::straight ? of(m) : of(m).reversed();
  }
  ThinFilm reversed() const { return {base_ior, film_ior, exterior_ior, thickness_nm}; }
};

struct FilmPower {
  Rgb reflectance;    // R in [0, 1]
  Rgb transmittance;  // 1 - R: the film absorbs nothing
};

// Returns the powers at the cosine of the angle in the exterior medium (0 <= cos_exterior <= 1), for three
// vacuum wavelengths in nm at once. R = 1 where exterior_ior * sin >= base_ior.
FilmPower airy(const ThinFilm& film, double cos_exterior, const Rgb& wavelengths_nm);

// Returns n0 / n2 if light bends when it passes the film, else 1. It does not bend in "straight" mode, nor
// between media so alike that the half vector of a crossing has no digits left.
inline double bending_index_ratio(const Material& material) {
  constexpr double kIndexMatch = 1e-7;
  const double ratio = material.exterior_ior / bending_base_ior(material);
  return material.transmission == Transmission::straight || std::abs(ratio - 1) <= kIndexMatch ? 1 : ratio;
}

}  // namespace sunbeam
