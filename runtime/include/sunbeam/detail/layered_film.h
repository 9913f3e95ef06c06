// This file says which films are stacks, and computes their powers at the wavelengths of a live model.
#pragma once

#include "sunbeam/detail/film_stack.h"
#include "sunbeam/detail/wavelengths.h"
#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// Says whether the film is more than one clear layer of constant index on a clear base, so that airy() does
// not serve it.
bool is_layered(const Material& material, const Wavelengths& wavelengths);

// Returns film and base at the wavelength of this number, of any film.
FilmStack film_stack(const Material& material, const Wavelengths& wavelengths, std::size_t k);

// Returns the optical path 2 sum(n d) straight through the film and back at the wavelength of this number,
// over the film's thickness.
double path_per_thickness(const Material& material, const Wavelengths& wavelengths, std::size_t k);

// Returns the film's powers in closed form, for any film.
StackSpectrum stack_spectrum(const Material& material, const Wavelengths& wavelengths,
                             double spread_orders = StackSpectrum::kAllOrders);

}  // namespace v1
}  // namespace sunbeam
