// This file hands out the tables of optical constants that the build compiles in from tables/optics/, so that
// a program has them wherever it is run. docs/reference/optics.md lists them.
#pragma once

#include <span>
#include <string_view>

namespace sunbeam {

// The refractive index n + i k at a vacuum wavelength.
struct OpticalConstants {
  double wavelength_nm;
  double n;
  double k;  // the extinction coefficient: k > 0 absorbs

  bool operator==(const OpticalConstants&) const = default;
};

struct OpticalTable {
  std::string_view name;                    // of the file, without ".csv"
  std::span<const OpticalConstants> lines;  // wavelengths ascend
};

// Returns all tables, in the order of their names in ASCII.
std::span<const OpticalTable> optical_tables();

}  // namespace sunbeam
