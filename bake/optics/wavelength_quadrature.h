// This file folds a spectrum into linear RGB by a weighted sum over wavelengths: rgb = sum_k weight_k
// s(lambda_k).
//
// The weights hold the observer, the illuminant and the colour space (with its chromatic adaptation); for
// each channel they sum to 1, so a grey spectrum keeps its value in every channel. Weights may be negative.
#pragma once

#include <span>
#include <vector>

#include "bake/optics/cie.h"
#include "bake/optics/thin_film.h"
#include "sunbeam/core/color_space.h"

namespace sunbeam {

struct WavelengthQuadrature {
  std::vector<double> wavelength_nm;  // vacuum, ascending or descending
  std::vector<Rgb> weight;

  std::size_t size() const { return weight.size(); }

  // Folds one spectrum value per wavelength.
  Rgb fold(std::span<const double> values) const {
    Rgb sum;
    for (std::size_t k = 0; k < size(); ++k) sum += values[k] * weight[k];
    return sum;
  }

  // Folds a function of the wavelength in nm.
  template <class Spectrum>
  Rgb fold_function(Spectrum spectrum) const {
    Rgb sum;
    for (std::size_t k = 0; k < size(); ++k) sum += spectrum(wavelength_nm[k]) * weight[k];
    return sum;
  }

  // Folds the film's reflectance and transmittance; it is exact in everything but the wavelengths.
  FilmPower fold_film(const ThinFilm& film, double cos_exterior) const;
};

// Returns the reference, which has a wavelength every 1 nm from 380 to 780 nm.
WavelengthQuadrature brute_force(Illuminant illuminant, ColorSpace space);

// These are the measured choice for films up to 2 n1 d0 = 2 * 1.8 * 1500 nm (table in docs/theory/color.md).
// The number of nodes is a multiple of 4.
inline constexpr int kDefaultNodes = 20;
inline constexpr double kDefaultLargestPathNm = 5400;

// Returns the number of nodes for films whose longest path 2 n1 d0 is `largest_path_nm`, in proportion to the
// measured choice: a multiple of 4, at least 16.
int nodes_for_path(double largest_path_nm);

// Holds the wavelengths of the first and the last node.
struct NodeRange {
  double first_nm, last_nm;

  bool operator==(const NodeRange&) const = default;
};
inline constexpr NodeRange kNodeRange{395, 720};  // is among the best for one clear film

// Returns `nodes` wavelengths uniform in 1 / lambda over the range. Per channel the weights minimise the
// squared error against brute_force() of cos(2 pi x / lambda) and sin(2 pi x / lambda), integrated over
// optical paths x from 0 to `largest_path_nm`, under the constraint that a constant comes out exact. The
// fringes of order m of a film are such waves with x = 2 m n1 d0 cos(theta1); give the longest path of order
// 1, orders 2 to 4 are added inside with small weights.
WavelengthQuadrature fitted(Illuminant illuminant, ColorSpace space, int nodes = kDefaultNodes,
                            double largest_path_nm = kDefaultLargestPathNm,
                            const NodeRange& range = kNodeRange);

// Solves a dense linear system, row after row in `matrix`, by elimination with partial pivoting. Returns
// false when it is singular; else `rhs` becomes the solution.
bool solve_linear(std::vector<double> matrix, std::vector<double>& rhs);

}  // namespace sunbeam
