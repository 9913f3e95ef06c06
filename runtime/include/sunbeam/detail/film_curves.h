// This file tabulates the powers of a film over the cosine, for films that no closed form serves in time: of
// several layers, absorbing ones, on an opaque base, dispersive, or the mean of uneven platelets.
//
// Light of one transverse direction (n sin(theta) is the same in all media) has one place in the table,
// whichever side it comes from: the coordinate is its cosine in the rarer of exterior and base, in which all
// powers are smooth. What the denser medium reflects totally has a table of its own if layers absorb.
// Directions are those of Material: below the film light travels by base_ior, also where the base's index
// depends on the wavelength, and in "straight" mode as outside.
//
// Values of live models are right to 1e-10. R + T = 1 holds to rounding where nothing absorbs. Const members
// are safe to share.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/panel_curve.h"
#include "sunbeam/detail/side.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam {
inline namespace v1 {

// Holds powers by wavelength, for light of one direction.
struct FilmPowers {
  using Numbers = std::array<double, kMostWavelengths>;
  Numbers reflectance;    // on the side that it comes from
  Numbers transmittance;  // the same both ways; 0 if the base is opaque
  Numbers reverse;        // reflectance for light that comes the other way; as above if there is none
};

class FilmCurves {
 public:
  // Says how precise the powers are: the panels, and the orders of fringes that a mean over platelets
  // resolves.
  struct Precision {
    PanelCurve::Accuracy panels;
    double spread_orders;
  };
  // Live models take the powers as exact. Their narrowest panels resolve a resonance of 1e-5 in the cosine,
  // and the square root where a dispersive base begins to reflect totally. Tables interpolate what comes of
  // theirs.
  static constexpr Precision kLive{{1e-9, 1e-12, 1e-7}, StackSpectrum::kAllOrders},
      kTable{{1e-5, 1e-6, 1e-4}, 2};

  FilmCurves(const Material& material, const Wavelengths& wavelengths, const Precision& precision = kLive);

  // Writes the powers at the wavelengths of these numbers, for light that travels on `side` of the film at
  // this cosine, 0 to 1, with the normal.
  void at(Side side, double cosine, std::span<const int> wavelengths, FilmPowers& powers) const;

  // Does the same for directions side by side, which lie inside where `is_inside` is 1 and outside where it
  // is 0. The powers of the i-th wavelength at direction k go to [i * cosine.size() + k].
  void at(const double* is_inside, std::span<const double> cosine, std::span<const int> wavelengths,
          double* reflectance, double* transmittance) const;

  // Returns the cosines on this side, from 0 to 1, between which the powers are as good as polynomials: of
  // the cosine, or of its refraction.
  std::vector<double> edges(Side side) const;

 private:
  void reflect_totally(double cosine, std::span<const int> wavelengths, FilmPowers& powers) const;
  bool is_in_rarer(Side side) const;
  bool is_base_rarer() const { return base_ior_ < exterior_ior_; }
  double denser_ior() const { return is_base_rarer() ? exterior_ior_ : base_ior_; }
  double rarer_ior() const { return is_base_rarer() ? base_ior_ : exterior_ior_; }

  double exterior_ior_, base_ior_;
  bool straight_, opaque_;
  std::size_t count_;
  double critical_;     // cosine of total reflection in the denser medium
  PanelCurve passing_;  // R from outside, T, R from below, a list after the other; by the coordinate
  PanelCurve total_;    // R of total reflection by the cosine over critical_; no panels if R = 1
};

}  // namespace v1
}  // namespace sunbeam
