// This file computes Airy's powers (thin_film.h has the equations and their letters) for fringe axes, in
// double precision. Lanes are thicknesses in equal steps, which share all but the phase; the phase goes on by
// rotation. R is right to 1e-13, T to 1e-12 of itself.
#pragma once

#include <span>

#include "bake/optics/thin_film.h"

namespace sunbeam {

// Computes reflectance and transmittance at thicknesses (first + j step) wavelengths, j = 0, 1, ...; the
// film's own thickness does not matter. `cosine` means the same as in airy(). Both spans have the same size.
void film_fringes(const ThinFilm& film, double cosine, double first, double step,
                  std::span<double> reflectance, std::span<double> transmittance);

}  // namespace sunbeam
