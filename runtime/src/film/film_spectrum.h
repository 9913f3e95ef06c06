// This file computes how much a thin film reflects at all wavelengths of a table, folded into RGB: what a
// renderer pays for a film that it does not look up. It evaluates Airy's formula for unpolarised light and
// media that absorb nothing, in single floats with several wavelengths to an instruction.
//
// With c_j the cosine in medium j, beta = n0 sin(theta_0), m_j = (n_j c_j)^2 = n_j^2 - beta^2, the phase
// x_k = 2 pi d sqrt(m_1) / lambda_k and S = sin^2(x_k),
//     T_k = (t / D_s + t / D_p) / 2,   t = 4 n0 c0 n2 c2,   R_k = 1 - T_k,
//     D_s = (n0 c0 + n2 c2)^2 + X S,        X = (n1^2 - n0^2) (n1^2 - n2^2) / m_1,
//     D_p = (n2 c0 + n0 c2)^2 + X F_0 F_2 S,  F_j = 1 - beta^2 (1 / n1^2 + 1 / n_j^2).
// It is T = 4 q0 q2 / (C^2 + D^2) of Born and Wolf, sec. 1.6, with cos^2 = 1 - sin^2 and the differences of
// squared admittances multiplied out. Where the wave is evanescent in the film (beta > n1), X S becomes
// X sinh^2(|x_k|) with |m_1|; where beta >= n2 or c0 = 0, T = 0.
//
// Precision, for thicknesses up to 3000 nm and wavelengths from 380 nm: |error of R_k| <= 1e-6, and T_k is
// right to 2e-6 of itself at cosines of 1e-3 and more (T below 1e-37 may become 0). Instruction sets differ
// by no more. R may come out as -1e-6 where it is 0. Cosines below 1e-9 count as 0.
#pragma once

#include <cstddef>
#include <span>

#include "sunbeam/detail/processor.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam {
inline namespace v1 {

struct FloatRgb {
  float r = 0, g = 0, b = 0;
};

// Holds a list for each quantity; beyond the last wavelength up to `padded` the last is repeated with no
// weight.
struct FilmWavelengths {
  static constexpr std::size_t kPadding = 16;

  explicit FilmWavelengths(const Wavelengths& wavelengths);

  // 2 / wavelength, 1/nm, is the sum of the two; the first has 12 bits.
  alignas(64) float per_high[kMostWavelengths], per_low[kMostWavelengths];
  float weight[3][kMostWavelengths];  // of each channel
  std::size_t count, padded;
  FloatRgb total_weight;  // the fold of 1
};

struct FilmKernels;  // compiled for one instruction set, see film_kernels.h

// Returns the fastest kernels that this machine runs, or those of the baseline if reproducible bits or
// SUNBEAM_KERNELS ask for them.
const FilmKernels& film_kernels(Arithmetic arithmetic);

// Evaluates a film of index n1 under an exterior of index n0. It is constant after construction, so threads
// may share it.
class FilmSpectrum {
 public:
  // Takes 1 to kMostWavelengths wavelengths, else it throws Error; indices >= 1.
  FilmSpectrum(const Wavelengths& wavelengths, double exterior_ior, double film_ior,
               const FilmKernels& kernels = film_kernels(Arithmetic::fastest));

  // Writes rgb[i] = sum_k weight_k R_k(cosines[i]) over a base of index n2; cosines are those in the
  // exterior, 0 to 1. `rgb` holds at least as many. Several at once cost less each than one.
  void fold(double thickness_nm, double base_ior, std::span<const float> cosines,
            FloatRgb* rgb) const noexcept;

  // Writes T_k = 1 - R_k of each wavelength, with relative precision. There are padded_count() values; those
  // from count() on mean nothing.
  void powers(double thickness_nm, double base_ior, float cosine, float* transmittance) const noexcept;

  std::size_t count() const noexcept { return wavelengths_.count; }
  std::size_t padded_count() const noexcept { return wavelengths_.padded; }

 private:
  FilmWavelengths wavelengths_;
  double exterior_ior_, film_ior_;
  const FilmKernels* kernels_;
};

}  // namespace v1
}  // namespace sunbeam
