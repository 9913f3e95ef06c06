// What L and X of a textured table are folded from: at every wavelength, the share A of a direction's light
// that reaches the base, at the columns (phi, root of the cosine) of TexturedGrid.
#pragma once

#include "runtime/src/film/film_spectrum.h"
#include "runtime/src/fit/order_stencil.h"
#include "runtime/src/fit/textured_grid.h"

namespace sunbeam::inline v1 {

// Nodes of (cos_theta, phi) that the value at a column is made of.
struct ColumnTap {
  std::size_t node;
  double weight;
};
std::vector<ColumnTap> column_taps(const TexturedGrid& grid, const Axis& cosines, const Axis& phis, int c,
                                   int p);

// At one base IOR and absorption after the other. What it is made of must outlive it.
class TexturedShares {
 public:
  static constexpr int kCosines = TexturedGrid::kCosines;

  TexturedShares(const Table& table, const TexturedGrid& grid, const FilmSpectrum& film);

  void move_to(double base_ior, double absorption);

  // A over exp(-least_decay()), as (wavelength, column): at a node of the thickness, or of the path.
  std::vector<float> at_thickness(int d) const;
  std::vector<float> at_path(int p) const;

  // Of the wavelength that the pigment absorbs least.
  double least_decay(int c) const { return least_decay_[static_cast<std::size_t>(c)]; }

  const Material& material() const { return material_; }
  // Of the pigment at the absorption that is moved to.
  double depth() const { return depth_; }
  // Of a path node, at which its thickness depends on the cosine.
  double thickness_nm(int p, int c) const;

 private:
  void find_stencils();
  void find_pigment();
  std::vector<float> at_columns(const NdArray& slice) const;
  template <class ArrivalAt, class ThicknessAt>
  std::vector<float> shares(ArrivalAt arrival_at, ThicknessAt thickness_at) const;
  template <class ThicknessAt>
  void let_pass(ThicknessAt thickness_at, std::vector<float>& shares) const;

  const Table& table_;
  const Wavelengths& waves_;
  const TexturedGrid& grid_;
  const FilmSpectrum& film_;
  std::size_t columns_;
  double least_;                          // absorption of any wavelength
  std::vector<OrderStencil> arrival_at_;  // (thickness, wavelength, cosine)
  std::vector<OrderStencil> path_at_;     // (path, wavelength)

  Material material_;
  double depth_ = 0;
  std::array<double, kCosines> least_decay_{};
  std::vector<float> pigment_;               // ln of what it leaves, as the shares
  std::vector<std::vector<float>> arrival_;  // of each wavelength: (fringe_order, column)
};

}  // namespace sunbeam::inline v1
