// This file folds B of a textured table (sunbeam/textured_table.h) from the shares of all wavelengths at one
// base IOR and absorption, and makes the nodes of L that stand for it.
#pragma once

#include "runtime/src/fit/textured_waves.h"
#include "runtime/src/rest/textured_media.h"

namespace sunbeam {
inline namespace v1 {

// Folds B and finds L. What it is made of must outlive it.
class TexturedFactor {
 public:
  TexturedFactor(const TexturedWaves& waves, const TexturedMedia& media, bool is_product);

  // Returns L over (path, column); the last lane is the chance of sampling the first surface.
  std::vector<Color4> nodes() const;

  // Returns B as a look-up finds it in these nodes, over exp(-least_decay()), at a node of the thickness.
  Rgb value(const std::vector<Color4>& nodes, int d, int c, int column) const;

  // Returns A over exp(-least_decay()) at a node of the thickness, as (wavelength, column).
  const std::vector<float>& shares(int d) const { return shares_[static_cast<std::size_t>(d)]; }

 private:
  // Holds the rest's directional albedo without the least decay, what it would be if all light arrived, and
  // P.
  struct Folded {
    Rgb arriving, all, passing;
  };

  void take_cosines();
  void take_quadrature();
  void weigh(int d);
  double hemispherical(const float* values) const;
  void fold(int p, Color4* columns) const;
  FloatRgb reflectance(double thickness_nm, int c) const;
  Rgb passing(int c, double thickness_nm, const FloatRgb& reflectance) const;
  Rgb faint_passing(int c, double thickness_nm) const;
  int cosines() const { return grid_.cosines; }
  Color4 node(const Folded& b, const Rgb& norm, int c, const FloatRgb& reflectance) const;
  double first_chance(const FloatRgb& r, double rest, int c) const;
  double decay(int channel, int c) const;

  const TexturedWaves& waves_;
  const TexturedMedia& media_;
  const TexturedGrid& grid_;
  bool is_product_;
  std::vector<float> film_cosines_, per_pigment_cosine_;  // c~ and 1 / m~
  std::vector<double> quadrature_;
  std::vector<std::vector<float>> shares_;  // of each thickness
  std::vector<double> weights_;             // (thickness, wavelength): g A*
  std::vector<Rgb> norms_;                  // (thickness): fold(g A* A*)
};

}  // namespace v1
}  // namespace sunbeam
