// A WaveField is what a factored table says of each wavelength at one base IOR and absorption, in the symbols
// of sunbeam/detail/factors.h, which stores the arrays that bake/factored/arrival.h, returned.h and
// exchange.h make:
//
//   depth  tau,   arrival  ln A but for the pigment,   gain  g,   bracket  V of path "product",
//   rest = g A(wi) A(wo) V(wi, wo),  V = 1 with path "sum".
//
// BoundWaves is it at one thickness and any direction, in doubles. TexturedWaves is it at all thicknesses and
// a few directions, in floats.
#pragma once

#include <span>
#include <vector>

#include "sunbeam/detail/factor_frame.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

class WaveField {
 public:
  // `material` is that of the table with the parameters of the point, which lie in the grid; its thickness is
  // of no matter. The table must outlive this.
  WaveField(const Table& table, const Material& material);

  std::size_t size() const { return depths_.size(); }
  const Wavelengths& wavelengths() const { return factors_.wavelengths; }
  const Material& material() const { return material_; }
  const FactorFrame& frame() const { return frame_; }

  double depth(std::size_t k) const { return depths_[k]; }
  // The arrivals are arrays over (fringe_order, direction), for a rough film. Wavelengths of one depth
  // have one slice in common, whose number is slice(k).
  std::size_t slice(std::size_t k) const { return slice_[k]; }
  const std::vector<NdArray>& arrivals() const { return arrivals_; }
  // Returns s kd / pi; with path "sum" all visits of the base add up to 1 / (1 - kd returned) of it.
  double gain(std::size_t k, double returned = 0) const;

 private:
  const Factors& factors_;
  Material material_;
  FactorFrame frame_;
  std::vector<double> depths_;
  std::vector<std::size_t> slice_;
  std::vector<NdArray> arrivals_;
};

// Holds a node of the two axes of a direction in an array, and its weight there.
struct DirectionTap {
  std::size_t node;
  double weight;
};
// `coordinate` is that of FactorFrame.
std::vector<DirectionTap> direction_taps(const Axis& cosines, const Axis& phis, double coordinate,
                                         double phi);

// Contracts one direction of `exchange`: adds to each node of the other what the array, (direction,
// direction), holds there.
void contract(std::span<const float> exchange, std::span<const DirectionTap> from, std::span<double> row);

// Returns V of two directions, whose one visit is at the cosines m_i and m_o below the film; `row` is
// exchange with the first contracted.
double bracket(double depth, double m_i, double m_o, std::span<const double> row,
               std::span<const DirectionTap> to);

}  // namespace v1
}  // namespace sunbeam
