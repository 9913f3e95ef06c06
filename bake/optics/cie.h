// This file holds the CIE 1931 2-degree standard colorimetric observer and the illuminants D65 and E, 380 to
// 780 nm.
//
// The numbers are those of the official tables at 5 nm in CIE 015:2018: colour-matching functions of ISO/CIE
// 11664-1 (also DOI 10.25039/CIE.DS.xvudnb9b) and D65 of ISO/CIE 11664-2 (also DOI 10.25039/CIE.DS.hjfjmt59).
// Between entries the observer follows the cubic through the four nearest entries, as CIE 167:2005 suggests,
// and D65 the straight line on which its standard is built.
#pragma once

#include <string_view>

#include "bake/optics/dispersion/visible.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {

enum class Illuminant { d65, e };

// Returns the name that recipes and tables use: "D65", "E".
constexpr std::string_view to_string(Illuminant illuminant) {
  return illuminant == Illuminant::e ? "E" : "D65";
}

// Returns x-bar, y-bar, z-bar at a wavelength in nm. They are dimensionless, with y-bar = 1 at 555 nm, and
// zero outside 380 to 780 nm.
Vec3 observer(double wavelength_nm);

// Returns the relative power per nm: D65 is 100 at 560 nm, E is 100 everywhere; zero outside 380 to 780 nm.
double illuminant_power(Illuminant illuminant, double wavelength_nm);

// Returns the tristimulus values of the illuminant itself with Y = 1: the sum of 401 terms from 380 to 780
// nm.
Vec3 illuminant_white(Illuminant illuminant);

}  // namespace sunbeam
