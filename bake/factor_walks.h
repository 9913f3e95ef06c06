// Values of the factored encoding (sunbeam/factors.h) by random walks.
//
// A leg of a walk - through the film to the base, or from the base to the film and back - chooses its
// direction by facets alone, which know neither thickness nor wavelength, pigment nor albedo. So the same
// legs serve every fringe order, optical depth and albedo: each leg is weighted with the film's powers at all
// orders and the pigment's at all depths. Legs are stratified in the square of visible normals, ever finer
// until independent replicates agree to the recipe's accuracy.noise, and the random numbers are the same at
// every base IOR, so that noise does not ripple along a slider.
//
// With path "product" a walk is a chain of such legs, joined by the base's exp(-tau / (m m')). Arrivals p and
// returns B are collected at nodes m_a of the cosine (each between its two neighbours), and all chains are
// summed at once:  rest = s kd/pi p_i^T (F + kd F B F + (kd F B)^2 F + ...) p_o,  F_ab = exp(-tau/(m_a m_b)).
#pragma once

#include "bake/bake_job.h"
#include "sunbeam/factors.h"

namespace sunbeam {

// Isotropic or anisotropic film, single facets, no scattering.
bool has_factors(const Material& material);

// Axes of the recipe's factored table: its arrays as outlines. Throws Error if it would be larger than a
// machine can hold.
Factors factor_axes(const Recipe& recipe);

// `recipe` must outlive the job. The table's `noise` is the relative standard error of A A, root mean square
// over all cells.
std::unique_ptr<BakeJob> factored_job(const Recipe& recipe, std::uint64_t seed);

}  // namespace sunbeam
