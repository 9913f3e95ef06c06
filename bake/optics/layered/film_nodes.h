// This file chooses the wavelengths of films that no rule for one clear film covers, by what they make of
// their reflectance.
#pragma once

#include "bake/optics/dispersion/film_design.h"
#include "bake/optics/spectrum.h"

namespace sunbeam {

// This much of the folded reflectance from above may be off against one wavelength every nm, as the 99th
// percentile over angles, thicknesses and channels: |R - R_1nm| / max(R_1nm, 0.01).
inline constexpr double kMostFoldingError = 0.003;

struct FilmNodes {
  WavelengthQuadrature quadrature;  // a multiple of 4 nodes, at most kMostWavelengths
  double path_nm;                   // the longest path 2 sum(n d) for which they serve; 0 if they do not
  double error;  // up to the thickness asked for; above kMostFoldingError if kMostWavelengths are too few
};

// Returns the fewest nodes that the rule for the path allows and that keep kMostFoldingError at thicknesses
// up to thickest_nm, whose path kMostWavelengths resolve. Metals and reflectors of steep edges take
// wavelengths from 385 to 760 nm where those of kNodeRange do not serve. They are measured without spread,
// which only smoothes. The path returned goes on beyond thickest_nm while the error stays and the nodes
// resolve it.
FilmNodes nodes_for_film(const Material& material, const FilmDesign& film, Illuminant illuminant,
                         ColorSpace space, double thickest_nm);

}  // namespace sunbeam
