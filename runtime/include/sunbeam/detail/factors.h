// This file defines the factored encoding of the rest: what walks have to find out about a film over a
// diffuse base without scattering, once for all wavelengths. bake/factored/arrival.h, returned.h and
// exchange.h make the arrays, runtime/src/fit/wave_field.h reads them.
//
// A film of thickness d at vacuum wavelength lambda acts by d / lambda alone, an absorbing pigment by its
// optical depth tau there. So the arrays hold no colours and no thickness: one axis of fringe orders serves
// every wavelength of every film. At each wavelength, with s = (n0/n2)^2 or 1 and kd the albedo of the base,
//
//   path "sum"      rest = s kd/pi A(wi) A(wo) / (1 - kd returned)                       (rank one, exactly)
//   path "product"  rest = s kd/pi A(wi) A(wo) [ exp(tau (1/m_i + 1/m_o - 1/(m_i m_o))) + exchange ]
//
// A(w) = the share of the power along w that reaches the base through film and pigment,
//        smooth film: A = T(c) exp(-tau/m), closed form,   c cosine of w, m cosine below the film,
//        rough film:  A = exp(arrival - tau/m~),           m~ = m kept away from 0 by the roughness (but m
//                                                          itself where light passes straight on);
// returned = the share of what leaves the base that the film sends back to it through the pigment. The first
// term of "product" is one visit of the base through facets that do not bend light, exactly there. Colours
// are rest = sum_k weight_k rest_k. docs/reference/table_format.md describes the arrays.
//
// A layered film (layered_film.h) is kept as it is, layer by layer, and its powers are evaluated when a table
// is bound. Facets know of it only through the cosine c' that light makes with them, so its arrays say how
// light is spread over c'. Let v be the share of the facets visible from w that w meets at a cosine below c',
// and u in [0, 1] their rank, v = u^3 / (u^3 + (1 - u)^3), which is dense at both ends, where c' changes
// fast:
//
//   rough film:  A = exp(-tau/m~) Int_0^1 T(facet_cosine) exp(crossing) dv,
//   path "sum":  returned = Int_0^1 R_below(return_cosine) returning dv,
//
// where the second pair is of facets that diffuse light meets from below. `crossing` is ln of the mean, over
// the facets of that c', of share exp(-tau/m), plus tau/m~. Since indices may depend on the wavelength,
// `exchange` of a layered film has it as an axis. This m~ is crossing_cosine().
//
// fringe_order = 2 n1 d cos_1 / lambda, the phase between successive reflections in the film over 2 pi, at
// the direction itself for `arrival`, at normal incidence for the other two. At a fixed order A varies slowly
// with the direction.
#pragma once

#include <vector>

#include "sunbeam/detail/axis.h"
#include "sunbeam/detail/nd_array.h"
#include "sunbeam/detail/wavelengths.h"
#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// Holds the arrays, with one number a cell. Directions are (cos_theta, phi), phi in [0, pi/2] for an
// anisotropic film and the one node 0 for an isotropic one.
struct Factors {
  std::vector<Axis> grid;  // the parameters as the recipe spans them, in the order of kParameterNames
  Wavelengths
      wavelengths;  // albedo of the base and relative absorption at each, their colours, a layered film

  NdArray arrival;   // (base_ior, optical_depth, fringe_order, cos_theta, phi); empty for a smooth film;
                     // one optical depth where it does not matter (straight)
  NdArray returned;  // path "sum":     (base_ior, optical_depth, fringe_order)
  NdArray exchange;  // path "product": (base_ior, optical_depth, albedo, fringe_order, cos_theta_i, phi_i,
                     //                  cos_theta_o, phi_o); layered: with wavelength_nm after albedo

  // Only layered films have these, rough ones the first two, path "sum" the last two.
  NdArray facet_cosine{};   // (theta, phi, facet_rank)
  NdArray crossing{};       // (base_ior, optical_depth, theta, phi, facet_rank), depths as of `arrival`
  NdArray return_cosine{};  // (facet_rank)
  NdArray returning{};      // (optical_depth, facet_rank)

  bool empty() const { return returned.empty() && exchange.empty() && returning.empty(); }
  bool operator==(const Factors&) const = default;
};

// Returns the share v of facets up to a rank in [0, 1], and the derivative of it by the rank.
inline double share_of_rank(double rank) {
  const double low = rank * rank * rank, high = (1 - rank) * (1 - rank) * (1 - rank);
  return low / (low + high);
}
inline double share_slope(double rank) {
  const double low = rank * rank * rank, high = (1 - rank) * (1 - rank) * (1 - rank);
  return 3 * square(rank * (1 - rank) / (low + high));
}

// Returns the fringe order of a direction at this cosine outside, for the material's film at a thickness of
// one nm and a wavelength of one nm.
double fringe_order(const Material& material, double cosine);

// Returns m~, which is explained above.
double arrival_cosine(const Material& material, double cosine);

// Returns m~ of `crossing`. Beyond the critical angle m is 0, and m~ would have a knee that no node of theta
// lies at; there it is rounded over the angle of the roughness. Over a base that is denser than the exterior
// it is arrival_cosine().
double crossing_cosine(const Material& material, double cosine);

// Returns exp(tau (1/m_i + 1/m_o - 1/(m_i m_o))), which is at most exp(tau).
double one_visit_of_product(double optical_depth, double m_i, double m_o);

}  // namespace v1
}  // namespace sunbeam
