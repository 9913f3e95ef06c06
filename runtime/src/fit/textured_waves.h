// This is a WaveField at the directions of a textured table's array L, for all thicknesses. It gives A
// relative to its least decay, in floats, several at a time.
#pragma once

#include <array>
#include <vector>

#include "runtime/src/film/film_spectrum.h"
#include "runtime/src/fit/wave_field.h"
#include "runtime/src/rest/textured_grid.h"

namespace sunbeam {
inline namespace v1 {

// Says where a fringe order lies among the nodes of an array, whose axis is even or has one node. There are
// always four nodes, so that loops have no branch; arrays carry kMoreOrders rows more.
struct OrderStencil {
  OrderStencil(const Axis& axis, double order);

  std::size_t first;
  std::array<float, 4> weight;
};
inline constexpr std::size_t kMoreOrders = 3;

// Interpolates `values`, which are (fringe_order, column) with `stride` columns.
inline float blend(const std::vector<float>& values, const OrderStencil& at, std::size_t stride,
                   std::size_t column) {
  const float* from = values.data() + at.first * stride + column;
  return at.weight[0] * from[0] + at.weight[1] * from[stride] + at.weight[2] * from[2 * stride] +
         at.weight[3] * from[3 * stride];
}

// Holds the fringe orders of all nodes of a grid. They depend on no pigment, and on no base IOR where the
// frame has no places.
struct TexturedOrders {
  TexturedOrders(const Table& table, const TexturedGrid& grid, const FactorFrame& frame);

  // These return the place of a wavelength in the arrays of those names.
  const OrderStencil& arrival_at_thickness(int d, std::size_t k, std::size_t c) const {
    return arrival[(static_cast<std::size_t>(d) * waves + k) * cosines + c];
  }
  const OrderStencil& arrival_at_path(int p, std::size_t k) const {
    return path[static_cast<std::size_t>(p) * waves + k];
  }
  // Returns its place in `returned` or `exchange`, whichever the table has.
  const OrderStencil& visits_at(int d, std::size_t k) const {
    return visits[static_cast<std::size_t>(d) * waves + k];
  }

  std::size_t waves, cosines;
  std::vector<OrderStencil> arrival, path, visits;
};

// Gives what the fit asks of each wavelength. What it is made of must outlive it.
class TexturedWaves {
 public:
  // `material` has the base IOR and the absorption.
  TexturedWaves(const Table& table, const Material& material, const TexturedGrid& grid,
                const TexturedOrders& orders, const FilmSpectrum& film);

  // These return A over exp(-least_decay()), as (wavelength, column), at a node of the thickness, or of the
  // path.
  std::vector<float> at_thickness(int d) const;
  std::vector<float> at_path(int p) const;

  // Returns the cosine of a node. Where a smooth film lets nothing in, it is the next that it lets in.
  double cosine(int c) const { return cosines_[static_cast<std::size_t>(c)]; }
  // Returns cos dw of a node over the step of its coordinate, azimuths included; 0 where nothing is let in.
  double measure(int c) const;

  // Returns tau/m~ of the wavelength that the pigment absorbs least.
  double least_decay(int c) const { return least_decay_[static_cast<std::size_t>(c)]; }

  // Returns the gain of a wavelength at a node of the thickness. What path "product" adds is in its bracket.
  double gain(int d, std::size_t k) const;

  // Returns the thickness of a path node, which depends on the cosine.
  double thickness_nm(int p, int c) const;

  const WaveField& field() const { return field_; }
  const TexturedGrid& grid() const { return grid_; }
  const TexturedOrders& orders() const { return orders_; }

 private:
  int cosines() const { return grid_.cosines; }
  void take_cosines();
  void take_pigment();
  void take_returned(const NdArray& returned);
  template <class ArrivalAt, class ThicknessAt>
  std::vector<float> shares(ArrivalAt arrival_at, ThicknessAt thickness_at) const;
  template <class ThicknessAt>
  void let_pass(ThicknessAt thickness_at, std::vector<float>& shares) const;

  const TexturedGrid& grid_;
  const TexturedOrders& orders_;
  const FilmSpectrum& film_;
  WaveField field_;
  std::size_t columns_;
  std::vector<double> cosines_, least_decay_;
  std::vector<float> pigment_;                // ln of what it leaves, as the shares
  std::vector<std::vector<float>> arrivals_;  // of each slice: (fringe_order, column)
  std::vector<std::vector<float>> returned_;  // of each wavelength with path "sum": (fringe_order)
};

}  // namespace v1
}  // namespace sunbeam
