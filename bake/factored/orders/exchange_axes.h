// This file chooses the nodes of `exchange` of a layered film (sunbeam/detail/factors.h) by what they make of
// V = 1 / (1 - kd rho), the light that all visits of a base under a smooth clear film add up to, where rho is
// the share of diffuse light that the film sends back. Mirrors have steep edges over fringe orders, and over
// a bright base what they send back makes V steep over the albedo.
#pragma once

#include "bake/recipe/recipe.h"
#include "sunbeam/detail/axis.h"

namespace sunbeam {

struct ExchangeAxes {
  Axis albedo, wavelength, fringe_order;
};

// Chooses them for the wavelengths of the recipe. `least_depth` is the least optical depth of the pigment.
ExchangeAxes exchange_axes(const Recipe& recipe, const Wavelengths& wavelengths, double least_depth);

// Says whether the indices of layers or base differ between the wavelengths.
bool is_dispersive(const Wavelengths& wavelengths);

}  // namespace sunbeam
