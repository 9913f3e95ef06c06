// Makes the array `crossing` of a layered film's table, which sunbeam/detail/factors.h stores and
// runtime/src/layers/layered_waves.h looks up: how much of the light that meets facets at one cosine reaches
// the base.
#pragma once

#include <span>
#include <vector>

#include "bake/factored/facets/facet_shares.h"
#include "sunbeam/material.h"

namespace sunbeam {

// Returns the values for one direction and base IOR, that of `material`, at (optical depth, facet cosine).
// Beyond the critical angle, where the film lets nothing in, they go on as they are at it.
std::vector<double> crossing_values(const Material& material, const VisibleFacets& facets,
                                    std::span<const double> cosines, std::span<const double> depths);

}  // namespace sunbeam
