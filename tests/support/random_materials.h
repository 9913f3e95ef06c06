// Materials drawn at random over everything that a recipe may ask for, and pairs of directions.
#pragma once

#include <cmath>
#include <utility>

#include "sunbeam/core/frame.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/material.h"

namespace sunbeam::test {

// Numbers of other kinds than uniform.
class Draws {
 public:
  explicit Draws(Rng& rng) : rng_(rng) {}

 protected:
  bool chance(double p) { return rng_.uniform() < p; }
  double between(double low, double high) { return low + (high - low) * rng_.uniform(); }
  double logarithmic(double low, double high) { return low * std::pow(high / low, rng_.uniform()); }

  Rng& rng_;
};

// Draws what the options of a material are taken from.
class RandomMaterials : private Draws {
 public:
  using Draws::Draws;

  // Every third one scatters. The exterior is air or a liquid, the base denser or thinner than it.
  Material draw(int index) {
    Material m;
    m.transmission = chance(0.5) ? Transmission::refract : Transmission::straight;
    m.film_thickness_nm = chance(0.1) ? 0 : between(0, 1500);
    m.exterior_ior = chance(0.4) ? 1 : between(1, 1.6);
    m.film_ior = between(1.2, 2);
    m.base_ior = base_ior(m.exterior_ior);
    m.absorption_per_nm = (chance(0.2) ? 0 : between(0, 2)) / m.pigment_thickness_nm;
    m.albedo = {rng_.uniform(), rng_.uniform(), rng_.uniform()};
    m.roughness = roughness();
    if (chance(0.35)) m.microfacet = Microfacet::multiple;
    if (index % 3 == 0) {
      m.scattering_per_nm = logarithmic(0.1, 10) / m.pigment_thickness_nm;
      m.anisotropy = anisotropy();
    } else if (chance(0.5)) {
      m.absorption_path = AbsorptionPath::product;
    }
    return m;
  }

  // Up to 89 degrees from the normal.
  Vec3 direction() {
    return spherical_direction(std::acos(between(std::cos(89 * kPi / 180), 1)), between(0, 2 * kPi));
  }

 private:
  // Often below the exterior's, so that grazing light is reflected totally.
  double base_ior(double exterior) {
    if (chance(0.1)) return exterior;
    return chance(0.3) ? between(1, exterior) : between(1, 2.5);
  }
  // From -0.95 to 0.99, as many within 0.1 of 1 as below 0.
  double anisotropy() {
    if (chance(0.3)) return between(-0.95, 0);
    return chance(0.5) ? between(0, 0.9) : between(0.9, 0.99);
  }
  Roughness roughness() {
    if (chance(0.3)) return 0;
    const double u = logarithmic(0.02, 0.7);
    return chance(0.3) ? Roughness(u, logarithmic(0.02, 0.7)) : Roughness(u);
  }
};

}  // namespace sunbeam::test
