// This file reads film and base out of [material]: one layer by film_ior, or [[material.film]] from top to
// bottom, and a base that is clear or absorbs.
#pragma once

#include "bake/optics/dispersion/film_design.h"
#include "runtime/config/config.h"
#include "sunbeam/material.h"

namespace sunbeam {

// Sets the numbers of film and base in `material` and returns what they do not say. An index of the base that
// depends on the wavelength leaves its values at 510 nm there. Throws Error naming the key.
FilmDesign read_film_and_base(const ConfigTable& config, Material& material);

// Returns the key that says how thick the film is.
const char* thickness_key(const ConfigTable& config);

// Throws Error if the film is `thickness_nm` > 0 thick without a layer that could be.
void require_proportions(const ConfigTable& config, const FilmDesign& film, double thickness_nm);

}  // namespace sunbeam
