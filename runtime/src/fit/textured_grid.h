// Where the nodes of a textured table's arrays L and X lie (sunbeam/textured_table.h).
#pragma once

#include <array>

#include "runtime/src/base/even_axis.h"
#include "sunbeam/table.h"

namespace sunbeam::inline v1 {

struct TexturedGrid {
  explicit TexturedGrid(const Table& table);

  static constexpr int kCosines = 13;  // even roots

  // Of a node; the cosine is kept from 0, where nothing arrives.
  static double cosine(int c);
  double phi(int p) const { return phis == 1 ? 0 : kPi / 2 * p / (phis - 1); }
  double path_nm(int node) const {
    return per_extent > 0 ? first_path + node / ((paths - 1) * double{per_extent}) : double{first_path};
  }

  // Directions of L, as (phi, root of the cosine), and of X.
  int columns() const { return phis * kCosines; }
  int pair_ends() const { return pair_cosines * pair_phis; }

  std::array<EvenAxis, 3> axes;  // of the parameters, in the order of kParameterNames
  int phis;                      // even azimuths in a quadrant; 1 for an isotropic film
  int paths;
  float first_path, per_extent = 0;  // nodes are even in thickness times path
  // Of an anisotropic film's pairs only every second cosine and every third azimuth are kept: they are many.
  int cosine_step, phi_step;
  int pair_cosines, pair_phis;
};

}  // namespace sunbeam::inline v1
