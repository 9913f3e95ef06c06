// This file says where the nodes of a textured table's arrays lie if its film is layered
// (sunbeam/textured_table.h). layered_fit.h makes the arrays, layered_rest.h looks them up.
#pragma once

#include "runtime/src/base/even_axis.h"
#include "runtime/src/textured/knee_cosines.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

struct LayeredGrid {
  // Chooses the nodes. Throws Error if the arrays would take too much memory, or too long to make.
  explicit LayeredGrid(const Table& table);

  // Nodes of film_thickness_nm and base_ior are points, the second running fastest.
  int points() const { return static_cast<int>(axes[0].size() * axes[1].size()); }
  int absorptions() const { return static_cast<int>(axes[2].size()); }
  Parameters parameters(int point, int absorption) const;

  // R is (point, cosine), P is (point, azimuth, cosine); cosines are even.
  double cosine(int c) const { return static_cast<double>(c) / (cosines - 1); }
  // Those of R and P are even in their place.
  KneeCosines knee(double base_ior) const {
    return has_knee ? KneeCosines(exterior_ior, base_ior) : KneeCosines();
  }
  double phi(int p) const { return phis == 1 ? 0 : kPi / 2 * p / (phis - 1); }
  std::size_t film_cells() const { return count(points(), cosines); }
  std::size_t share_cells() const { return has_rest ? count(points(), phis, cosines) : 0; }

  // L is (point, absorption, azimuth, cosine), with fewer cosines. A column is a direction of it.
  static constexpr int kLogCosines = 49;
  int columns() const { return phis * kLogCosines; }
  double cosine_of_column(int column) const {
    return static_cast<double>(column % kLogCosines) / (kLogCosines - 1);
  }
  double phi_of_column(int column) const { return phi(column / kLogCosines); }
  std::size_t log_cells() const { return has_rest ? count(points(), absorptions(), columns()) : 0; }

  // X is (point, absorption, end, end). Ends are some of the columns of L, as (azimuth, cosine).
  int pair_cosines() const { return (kLogCosines - 1) / cosine_step + 1; }
  int pair_phis() const { return (phis - 1) / phi_step + 1; }
  int ends() const { return pair_phis() * pair_cosines(); }
  int column_of_end(int end) const {
    return end / pair_cosines() * phi_step * kLogCosines + end % pair_cosines() * cosine_step;
  }
  std::size_t pair_cells() const { return has_rest ? count(points(), absorptions(), ends() * ends()) : 0; }

  std::array<Axis, 3> axes;      // nodes of the parameters
  std::array<EvenAxis, 3> even;  // their ranges; the nodes of thickness and absorption are these
  bool has_rest, is_product;     // nothing lies below the film on an opaque base
  bool has_knee;                 // some base IOR lies below the exterior's
  double exterior_ior;
  int cosines, phis;  // even azimuths in a quadrant; 1 for an isotropic film
  int cosine_step = 1, phi_step = 1;

 private:
  static std::size_t count(int a, int b, int c = 1) {
    return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
  }
  void fit_memory();
};

}  // namespace v1
}  // namespace sunbeam
