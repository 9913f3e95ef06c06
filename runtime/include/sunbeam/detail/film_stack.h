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

#include <array>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

#include "sunbeam/detail/wavelengths.h"

namespace sunbeam {
inline namespace v1 {

// The longest path 2 sum(n d) that the mean over uneven platelets is taken of.
inline constexpr double kMostFilmWaves = 100;

struct FilmStack {
  double exterior_ior;              // n0 > 0
  std::vector<FilmLayer> layers;    // from top to bottom
  std::complex<double> base_index;  // n2 + i k2
  int periods = 1;                  // of the layers
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

// One film at several wavelengths, or the mean over its platelets of uneven thickness.
class StackSpectrum {
 public:
  // The mean over a spread resolves fringes of so many orders; with four it is right to 1e-10.
  static constexpr double kAllOrders = 4;

  // Takes a stack for each wavelength, equal in number of layers and periods. `spread` is the relative
  // standard deviation of one factor on all thicknesses, normal and cut at three deviations; at most 1 / 3.
  // With a spread it throws Error if the path 2 sum(n d) is longer than kMostFilmWaves wavelengths.
  StackSpectrum(const std::vector<FilmStack>& stacks, const std::vector<double>& wavelengths_nm,
                double spread = 0, double spread_orders = kAllOrders);

  std::size_t wavelengths() const { return count_; }
  // Returns how many numbers powers() writes to each list: wavelengths(), filled up to a multiple of four.
  std::size_t lanes() const { return lanes_.size() * kLanes; }

  // Writes the powers of light whose angle has this cosine > 0 in a clear medium of the index ior_from. The
  // other media hold it at the angle that Snell's law gives it, which may be none. `above`: reflectance from
  // above, 1 if there is no angle in the exterior; `through`: transmittance; `below`: reflectance from below,
  // that from above where the base has no angle.
  void powers(double ior_from, double cosine, double* above, double* through, double* below) const;

 private:
  static constexpr std::size_t kLanes = 4;  // wavelengths side by side
  using Numbers = std::array<double, kLanes>;
  struct Index {
    Numbers n{}, k{};
  };
  // Some wavelengths of the stack. `phase` is 2 pi d / lambda.
  struct Lanes {
    std::vector<Index> layers;
    std::vector<Numbers> phase;
    Index base;
  };

  void add_powers(const Lanes& lanes, double ior_from, double cosine, double* above, double* through,
                  double* below) const;

  std::size_t count_;
  double exterior_ior_;
  int periods_;
  std::vector<Lanes> lanes_;
  std::vector<std::pair<double, double>> factors_;  // on all thicknesses, and their weights
};

}  // namespace v1
}  // namespace sunbeam
