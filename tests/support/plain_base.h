// The diffuse base under its absorbing pigment layer, as one reflector seen from just below the film.
//
// f1(mi, mo) = albedo / pi * exp(-tau path), path = 1 / (cos_i cos_o) or 1 / cos_i + 1 / cos_o. No azimuth.
#pragma once

#include "sunbeam/core/rng.h"
#include "sunbeam/material.h"
#include "tests/support/warps.h"

namespace sunbeam {

class PigmentedBase {
 public:
  explicit PigmentedBase(const Material& material) : material_(material) {}

  // f1 in 1/sr, cosines > 0.
  Rgb value(double cos_i, double cos_o) const {
    return material_.albedo * (kInvPi * std::exp(material_.absorption_exponent(cos_i, cos_o)));
  }

  struct Sample {
    Vec3 direction;
    Rgb weight;      // f1 * cos / density, at most 2 albedo / (2 + a) exp(-a)
    double density;  // 1/sr
  };

  // Density cos^(1 + a): its slope at the normal is that of cos * exp(-a / cos), so the weight is bounded.
  Sample sample(double cos_in, Rng& rng) const {
    const double power = exponent(cos_in);
    const Vec3 direction = sample_power_cosine(power, {rng.uniform(), rng.uniform()});
    const double density = power_cosine_pdf(power, direction.z);
    if (!(density > 0) || direction.z <= 0) return {direction, Rgb(), 1};
    return {direction, value(cos_in, direction.z) * (direction.z / density), density};
  }
  double density(double cos_in, double cos_out) const { return power_cosine_pdf(exponent(cos_in), cos_out); }

 private:
  double exponent(double cos_in) const {
    const double tau = material_.optical_depth();
    return 1 + (material_.absorption_path == AbsorptionPath::product ? tau / cos_in : tau);
  }

  Material material_;
};

}  // namespace sunbeam
