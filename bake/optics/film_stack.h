// This file computes the powers that a stack of plane layers reflects and lets through, absorbing ones
// included.
//
// Indices are N = n + i k, fields go as exp(-i omega t), and S = n0 sin(theta_0) is the same in all media, so
// that c_j^2 = 1 - (S / N_j)^2. With delta = 2 pi N c d / lambda and q = N c (s-polarised) or c / N
// (p-polarised), the tangential fields of polarisation s below and above a layer are
//     (E, H)_above = (cos(delta) E - i sin(delta) / q H,  cos(delta) H - i q sin(delta) E)_below,
// and those of p are the same with E and H exchanged. From (1, q2) in the base the layers are passed from the
// bottom up, and with the (E, H) that arrive at the exterior
//     R = |(q0 E - H) / (q0 E + H)|^2,   T = 4 q0 Re(q2) / |q0 E + H|^2.
// Source: Born and Wolf, sec. 1.6. Going up, a field grows in media that damp it going down, so nothing is
// lost to cancellation; every layer is multiplied by exp(i delta), whose power is taken out again in T alone.
// sin(delta) / c and c sin(delta) are functions of c^2, smooth where a wave turns evanescent.
#pragma once

#include <complex>
#include <optional>
#include <vector>

namespace sunbeam {

struct FilmLayer {
  double thickness_nm;         // >= 0
  std::complex<double> index;  // n + i k, n > 0, k >= 0 absorbs
};

struct FilmStack {
  double exterior_ior;              // n0 > 0
  std::vector<FilmLayer> layers;    // from top to bottom
  std::complex<double> base_index;  // n2 + i k2
};

// The powers of unpolarised light. What is missing in reflectance + transmittance = 1 is absorbed by the
// layers.
struct StackPower {
  double reflectance;    // from above
  double transmittance;  // into the base; between clear media it is the same both ways
};

// Returns the powers at the cosine of the angle in the exterior medium, 0 <= cos_exterior <= 1, and a vacuum
// wavelength in nm. Nothing is let through into a clear base beyond its critical angle, or at cos_exterior =
// 0, where all is reflected.
StackPower stack_power(const FilmStack& stack, double cos_exterior, double wavelength_nm);

// Returns the reflectance from below of the direction that light takes in the base if it comes from above at
// cos_exterior; nothing if the base absorbs or there is no such direction.
std::optional<double> reflectance_below(const FilmStack& stack, double cos_exterior, double wavelength_nm);

}  // namespace sunbeam
