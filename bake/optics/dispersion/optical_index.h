// This file holds the refractive index n + i k of a medium over wavelength: one number, Cauchy's formula, a
// list of measured values, or a table of optical constants by its name.
//
// n lies in kLeastIor to kLargestIor and k in 0 to kMostExtinction at every visible wavelength, 380 to 780
// nm: an index that leaves these ranges is not made. Wavelengths are those in vacuum.
#pragma once

#include <array>
#include <complex>
#include <string>
#include <string_view>
#include <vector>

#include "bake/optics/dispersion/optical_tables.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam {

// Values of a list must reach from the one wavelength to the other. What the eye sees beyond them is little,
// and the values at the ends of a list stand for it.
inline constexpr double kListBeginsByNm = 400, kListEndsFromNm = 700;

class OpticalIndex {
 public:
  // Takes the same index at every wavelength. Throws Error if n or k is out of range.
  static OpticalIndex constant(double n, double k = 0);

  // Takes n = A + B / wavelength^2 + C / wavelength^4, with B in nm^2 and C in nm^4, and the same k at every
  // wavelength. Throws Error if n leaves its range at a visible wavelength, or k its own.
  static OpticalIndex cauchy(const std::array<double, 3>& coefficients, double k = 0);

  // Joins values by straight lines in n and in k. Throws Error if a value is out of range, if wavelengths do
  // not ascend, or if they do not reach from kListBeginsByNm to kListEndsFromNm.
  static OpticalIndex measured(std::vector<OpticalConstants> lines);

  // Takes a table of optical constants. Throws Error if there is none of that name.
  static OpticalIndex named(std::string_view name);

  // Returns the index at a wavelength > 0. Measured values hold at visible wavelengths beyond their ends.
  // Throws Error at wavelengths that are neither visible nor between measured values, and where Cauchy's
  // formula leaves the range of n.
  std::complex<double> at(double wavelength_nm) const;

  bool operator==(const OpticalIndex&) const = default;

 private:
  OpticalIndex() = default;

  std::array<double, 3> cauchy_{};       // unless measured
  double extinction_ = 0;                // beside cauchy_
  std::vector<OpticalConstants> lines_;  // empty unless measured
};

// Returns the names that OpticalIndex::named() knows.
std::vector<std::string> optical_table_names();

}  // namespace sunbeam
