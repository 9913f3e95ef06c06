// This file reads the refractive index of a medium out of a section of a recipe:
//     ior = 1.56                                  a number, with `extinction` beside it if the medium absorbs
//     ior = { cauchy = [1.517, 8800] }            A, B (nm^2) and perhaps C (nm^4), with `extinction`
//     likewise ior = [[400, 1.6], [700, 1.5, 0.01]]        lists of wavelength in nm, n and perhaps k ior =
//     "chitin"                              a table of optical constants
#pragma once

#include "bake/optics/dispersion/optical_index.h"
#include "runtime/config/config.h"

namespace sunbeam {

// Reads the index at `ior_key`, which must be there, and the extinction at `extinction_key`. Throws Error for
// anything else than the four forms, for values out of range, and for an extinction beside a list or a name.
OpticalIndex read_optical_index(const ConfigTable& config, const char* ior_key, const char* extinction_key);

}  // namespace sunbeam
