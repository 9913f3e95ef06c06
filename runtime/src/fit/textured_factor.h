// B of a textured table (sunbeam/textured_table.h), folded from shares, and the nodes of L that stand for it.
#pragma once

#include "runtime/src/fit/textured_shares.h"
#include "runtime/src/lookup/textured_rest.h"

namespace sunbeam::inline v1 {

// What it is made of must outlive it. `rest` need not have nodes yet.
class TexturedFactor {
 public:
  TexturedFactor(const Table& table, const TexturedRest& rest, const TexturedShares& shares);

  // To where the shares are now.
  void move();

  // L at all columns of a path node; the last lane is the chance of sampling the first surface.
  void fold(int p, Color4* columns) const;

  // B as L says it, over exp(-least_decay()).
  Rgb value(const Color4& log, int c, double thickness_nm) const;

  // g of a wavelength at a node of the thickness. Without a base that knows where light comes from (path
  // "product") `returned` is left to X.
  double gain(int d, std::size_t k) const;

 private:
  static constexpr int kCosines = TexturedGrid::kCosines;

  void find_frames();
  void find_quadrature();
  void take_returned();
  void weigh(int d);
  double hemispherical(const float* values) const;
  FloatRgb reflectance(double thickness_nm, int c) const;
  Color4 passing(int c, const FloatRgb& reflectance) const;
  Color4 node(const Rgb& b, const Rgb& norm, int c, const FloatRgb& reflectance) const;
  double first_chance(const FloatRgb& r, double rest, int c) const;
  double decay(int channel, int c) const;

  const Table& table_;
  const Wavelengths& waves_;
  const TexturedRest& rest_;
  const TexturedGrid& grid_;
  const TexturedShares& shares_;
  std::vector<OrderStencil> returned_at_;  // (thickness, wavelength)

  std::array<float, kCosines> film_cosines_{}, path_{};  // c~ and 1 / m~
  std::array<double, kCosines> quadrature_{};
  std::vector<std::vector<float>> returned_;  // of each wavelength: (fringe_order)
  std::vector<double> weights_;               // (thickness, wavelength): g A*
  std::vector<Rgb> norms_;                    // (thickness): fold(g A* A*)
};

}  // namespace sunbeam::inline v1
