// This file computes the powers of layered films over fringe orders, for legs (bake/factored/legs.h) and for
// the choice of axes (exchange_axes.h). At one wavelength a film acts by its thickness over the wavelength
// alone, of which the order is a measure: 2 sum(n d) / lambda.
#pragma once

#include <span>
#include <vector>

#include "sunbeam/detail/film_stack.h"
#include "sunbeam/detail/side.h"
#include "sunbeam/detail/wavelengths.h"
#include "sunbeam/material.h"

namespace sunbeam {

// Returns the film at these orders, where others have wavelengths. `one` holds a single wavelength; its
// layers and indices are those of all orders.
StackSpectrum stack_at_orders(const Material& material, const Wavelengths& one,
                              std::span<const double> orders);

// Returns the index of the medium in which light on this side of the film has its direction.
double ior_of(const Material& material, Side side);

// Tabulates the powers of light from one side over the cosine, between whose nodes they are joined by
// straight lines.
class StackPowers {
 public:
  StackPowers(const Material& material, const Wavelengths& one, Side side, std::span<const double> orders);

  // Writes the powers at all orders, at a cosine from 0 to 1.
  void at(double cosine, std::span<double> reflectance, std::span<double> transmittance) const;

 private:
  const double* row(std::size_t node) const { return rows_.data() + node * 2 * orders_; }

  std::size_t orders_, steps_;
  std::vector<double> rows_;  // at each node reflectances, then transmittances
};

}  // namespace sunbeam
