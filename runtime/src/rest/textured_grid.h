// This file says where the nodes of a textured table's arrays L and X lie (sunbeam/textured_table.h).
// runtime/src/fit/textured_fit.h makes the arrays, textured_rest.h looks them up.
#pragma once

#include <array>

#include "runtime/src/base/even_axis.h"
#include "sunbeam/detail/factor_frame.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

struct TexturedGrid {
  explicit TexturedGrid(const Table& table);

  // These return the direction and the path of a node; the cosine is kept from 0, where nothing arrives.
  double coordinate(int c) const { return static_cast<double>(c) / (cosines - 1); }
  double cosine(const FactorFrame& frame, int c) const;
  double phi(int p) const { return phis == 1 ? 0 : kPi / 2 * p / (phis - 1); }
  double path_nm(int node) const {
    return per_extent > 0 ? first_path + node / ((paths - 1) * double{per_extent}) : double{first_path};
  }

  // These count the directions of L, as (phi, cosine), and of X.
  int columns() const { return phis * cosines; }
  int pair_ends() const { return pair_cosines * pair_phis; }

  // L is (path, base_ior, absorption_per_nm, phi, cosine). These return the cells from path to
  // path, and the cell at the first path and direction.
  std::size_t path_stride() const {
    return static_cast<std::size_t>(axes[1].size() * axes[2].size() * columns());
  }
  std::size_t row(int base_ior, int absorption) const {
    return static_cast<std::size_t>((base_ior * axes[2].size() + absorption) * columns());
  }
  std::size_t cells() const { return static_cast<std::size_t>(paths) * path_stride(); }

  // X is (film_thickness_nm, base_ior, absorption_per_nm, direction, direction). This returns the first cell
  // at a node of the parameters.
  std::size_t first_pair(int thickness, int base_ior, int absorption) const {
    const int node = (thickness * axes[1].size() + base_ior) * axes[2].size() + absorption;
    return static_cast<std::size_t>(node) * static_cast<std::size_t>(pair_ends() * pair_ends());
  }
  std::size_t pair_cells() const { return first_pair(axes[0].size(), 0, 0); }

  // Locates a path; `path` is relative to that at normal incidence: textured_path().
  EvenPosition locate_path(float thickness_nm, float path) const {
    return {std::max((thickness_nm * path - first_path) * per_extent, 0.0f), paths};
  }

  bool is_warped;  // of FactorFrame: nodes are even in the warped cosine, else in the root
  int cosines;
  std::array<EvenAxis, 3> axes;  // of the parameters, in the order of kParameterNames
  int phis;                      // even azimuths in a quadrant; 1 for an isotropic film
  int paths;
  float first_path, per_extent = 0;  // nodes are even in thickness times path
  // Pairs are many. Of those of an anisotropic film, or of a base below the exterior, only some are kept.
  int cosine_step, phi_step;
  int pair_cosines, pair_phis;
};

}  // namespace v1
}  // namespace sunbeam
