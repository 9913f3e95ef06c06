// This file folds B of a textured table whose film is layered (sunbeam/textured_table.h) from the shares of
// all wavelengths at one point of the parameters.
#pragma once

#include <vector>

#include "runtime/src/base/color4.h"
#include "runtime/src/fit/wave_field.h"
#include "runtime/src/layers/layered_waves.h"
#include "runtime/src/textured/layered_grid.h"

namespace sunbeam {
inline namespace v1 {

// The least cosine of a node: at 0 nothing arrives.
inline constexpr double kLeastTexturedCosine = 1e-4;

// Holds the directions of L, which all absorptions share. Where a smooth film lets nothing in, a direction
// gives way to the next that it lets in.
struct LayeredDirections {
  LayeredDirections(const LayeredWaves& waves, const LayeredGrid& grid, Material material, double base_ior);

  std::vector<double> cosines, measure;  // of each column; cos dw of it, in the mean over a quadrant
  std::vector<LayeredWaves::Passage> passages;
};

class LayeredFactor {
 public:
  // What it is made of must outlive it. `absorption` holds a of each channel, and their mean.
  LayeredFactor(const Table& table, const LayeredGrid& grid, const LayeredWaves& waves,
                const LayeredDirections& directions, const Parameters& at, const Color4& absorption);

  // Returns B of a direction, and of the columns of L.
  Rgb fold(const LayeredWaves::Passage& w) const;
  const std::vector<Rgb>& values() const { return values_; }

  // Writes L, given B at the least absorption, and the chance of sampling the first surface.
  void take_logs(const std::vector<Rgb>& least, Color4* logs) const;

  // These return g of a wavelength, and A of a column at each.
  double gain(std::size_t k) const { return gains_[k]; }
  const double* shares(int column) const {
    return &shares_[static_cast<std::size_t>(column) * field_.size()];
  }

  double cosine_of(int column) const { return directions_.cosines[static_cast<std::size_t>(column)]; }
  const WaveField& field() const { return field_; }
  const Color4& absorption() const { return absorption_; }

 private:
  void weigh();
  Rgb folded(const double* shares) const;
  double first_chance(int column) const;

  const Table& table_;
  const LayeredGrid& grid_;
  const LayeredWaves& waves_;
  const LayeredDirections& directions_;
  const Color4& absorption_;
  WaveField field_;
  std::vector<double> gains_;
  std::vector<double> shares_;    // (column, wavelength)
  std::vector<double> arriving_;  // A* of each wavelength
  std::vector<Rgb> weights_;      // of each wavelength in B
  std::vector<Rgb> values_;       // B of each column
};

}  // namespace v1
}  // namespace sunbeam
