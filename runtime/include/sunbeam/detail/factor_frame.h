// This file says how the arrays `arrival` and `exchange` of a factored table (factors.h) are looked up at one
// base IOR. The bake encodes (bake/factored/arrival.h, exchange.h) and look-ups decode
// (runtime/src/fit/wave_field.h). Both are here since each is the inverse of the other.
//
// Where no base IOR of the grid lies below the exterior's, with tau the optical depth and m~ the cosine below
// a rough film that is kept away from 0,
//
//   arrival = ln A + tau/m~,   over the cosine c.
//
// A base of lower index reflects totally beyond the critical angle, whose cosine c* = sqrt(1 - (n2/n0)^2)
// moves with the base IOR (c* = 0 where n2 >= n0). In a rough film's table whose grid reaches below n0,
//
//   arrival = ln(A + 1e-4) + tau/c with "straight",  ln(A + 1e-4) with "refract",
//   over the warped cosine t = (u(c) - u(0.001)) / (u(1) - u(0.001)),
//   u(c) = (c - c*) / sqrt(|c - c*| + a),   a = sqrt(alpha_u alpha_v),
//   one visit at hypot(m, a/2) in place of m with "refract".
//
// So the nodes of a direction move with the critical angle, and a base IOR in between interpolates at a fixed
// t. Facets let some light pass beyond the critical angle, which no pigment's decay along one cosine fits.
#pragma once

#include "sunbeam/detail/axis.h"
#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// Returns the least cosine of directions in arrays.
inline constexpr double kLowestArrayCosine = 1e-3;

// Says whether a grid's base IORs, which run upwards from this one, reach below the exterior's, so that light
// is reflected totally. Nothing passes into an opaque base at all.
inline bool reaches_below_exterior(const Material& material, double lowest_base_ior) {
  return !material.is_opaque() && lowest_base_ior < material.exterior_ior;
}

// Returns c*.
double critical_cosine(const Material& material);

// Returns the cosine itself, or, of a direction that a smooth film keeps out or lets in at a cosine below it
// of less than `least_below`, that of one at least_below. What is divided by a share of light that vanishes
// at the critical angle has its limit there.
double entering_cosine(const Material& material, double cosine, double least_below = 0.01);

// Returns the axis whose coordinate is u. It has no nodes.
Axis critical_axis(const Material& material);

class FactorFrame {
 public:
  // `material` has the base IOR of the look-up; `reaches_below` is true if some of its grid lies below n0.
  FactorFrame(const Material& material, bool reaches_below);

  // Says whether directions lie at warped cosines, on axes named warped_cos in place of cos_theta.
  bool is_warped() const { return is_warped_; }
  // Returns the coordinate of a cosine on the axis of a direction: t, or the cosine.
  double coordinate(double cosine) const;
  // Returns the cosine of a coordinate, and the derivative of it by a warped one.
  double cosine(double coordinate) const;
  double slope(double coordinate) const;

  // Returns m~, which is infinite where `arrival` holds what the pigment absorbs.
  double pigment_cosine(double cosine) const;
  // Returns the cosine below the film that one visit of the base is taken at.
  double one_visit_cosine(double cosine) const;

  // These turn A into `arrival` and back; `decay` = tau/m~.
  double arrival(double share, double decay) const;
  double share(double arrival, double decay) const;
  // Returns what is added to A before its logarithm is taken.
  double floor() const { return floor_; }

 private:
  Material material_;
  bool is_warped_;
  double floor_;
  Axis critical_;
  double first_, extent_;  // of u
};

}  // namespace v1
}  // namespace sunbeam
