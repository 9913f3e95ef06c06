// This file makes material parameters functions of the wavelength: an albedo uplifted from RGB, and relative
// spectral absorption.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bake/optics/wavelength_quadrature.h"

namespace sunbeam {

// A curve holds pairs of wavelength in nm (ascending, at least one) and value. They are joined by straight
// lines; the curve is constant beyond the first and last.
using SpectralCurve = std::vector<std::pair<double, double>>;
double interpolate(const SpectralCurve& curve, double wavelength_nm);

// Returns the reflectance in [0, 1] at the wavelengths of the quadrature (one row of wavelengths uniform in 1
// / lambda or in lambda) whose fold is `albedo`, a linear colour in [0, 1] of the quadrature's colour space,
// to 1e-9.
//
// Of all such spectra this is the one with the least sum of squared steps of its logit from wavelength to
// wavelength: the method of least hyperbolic tangent slope squared (Burns, "Numerical methods for smoothest
// reflectance reconstruction", Color Research and Application 45, 2020). Grey gives the constant spectrum
// exactly.
//
// Throws sunbeam::Error outside [0, 1], and where no reflectance has the colour (highly saturated colours of
// ACEScg); the message then names the reachable colour nearest to it on the way to the grey of its mean.
std::vector<double> uplift_albedo(const WavelengthQuadrature& quadrature, const Rgb& albedo);

// Gives the absorption coefficient relative to the one at 510 nm.
class AbsorptionShape {
 public:
  static constexpr double kReferenceNm = 510;

  // The shape is 1 at all wavelengths.
  static AbsorptionShape flat() { return AbsorptionShape({}, 0); }

  // The points hold absorption in any unit, >= 0 and positive at 510 nm.
  static AbsorptionShape table(SpectralCurve points);

  // The shape is (510 nm / lambda)^exponent:
  //   "eumelanin"    3.48: melanosomes of skin, S. L. Jacques, "Melanosome absorption coefficient", Oregon
  //                  Medical Laser Center 1998 (1.70e12 lambda^-3.48 per cm).
  //   "pheomelanin"  4.75: C. Donner and H. W. Jensen, "A spectral BSSRDF for shading human skin", EGSR 2006
  //                  (2.9e14 lambda^-4.75 per mm).
  static AbsorptionShape pigment(const std::string& name);

  double operator()(double wavelength_nm) const;

 private:
  AbsorptionShape(SpectralCurve points, double exponent) : points_(std::move(points)), exponent_(exponent) {}

  SpectralCurve points_;  // empty: a power law
  double exponent_;
};

}  // namespace sunbeam
