// This file reads [material] of a recipe but for its albedo and absorption spectrum, which belong to the
// spectrum.
#pragma once

#include <string>

#include "bake/optics/dispersion/film_design.h"
#include "runtime/config/config.h"
#include "sunbeam/material.h"

namespace sunbeam {

struct MaterialKeys {
  Material material;
  FilmDesign film;
};

// Below an opaque base nothing is seen: keys of what lies there are refused, and albedo and absorption are 0.
// Throws Error naming the key.
MaterialKeys read_material(const ConfigTable& config);

}  // namespace sunbeam
