// Films drawn at random over everything that a layered one may be, for materials drawn at random.
#pragma once

#include <complex>
#include <vector>

#include "sunbeam/detail/wavelengths.h"
#include "tests/support/random_materials.h"

namespace sunbeam::test {

class RandomFilms : private Draws {
 public:
  using Draws::Draws;

  // Gives the material a film of 1 to 20 layers, often absorbing or dispersive ones, of which some repeat,
  // and every seventh an opaque base; returns all three wavelengths.
  Wavelengths draw(int index, Material& m) {
    const bool absorbs = chance(0.45), disperses = chance(0.5);
    const int most = 1 + static_cast<int>(20 * rng_.uniform() * rng_.uniform());
    const int periods = chance(0.4) ? 1 + static_cast<int>(most * rng_.uniform()) : 1;
    std::vector<Layer> layers;
    for (int j = 0; j < std::max(1, most / periods); ++j) layers.push_back(layer(absorbs, disperses));
    m.film_thickness_nm = between(20, 150) * periods * static_cast<double>(layers.size());
    if (chance(0.4)) m.thickness_spread = between(0.01, 0.2);
    if (index % 7 == 3) make_opaque(m);
    Wavelengths w = Wavelengths::rgb3(m);
    w.film_periods = periods;
    const double slope = disperses ? between(0, 0.01) : 0;
    for (const double nm : w.nm) {
      w.layers.emplace_back();
      for (const Layer& l : layers) w.layers.back().push_back({l.share, l.index(nm)});
      if (disperses) w.base_index.emplace_back(m.base_ior + slope * bend(nm), m.base_extinction);
    }
    return w;
  }

 private:
  // The term of Cauchy's that vanishes at 510 nm, which bends light in the base.
  static double bend(double nm) { return 1e6 / (nm * nm) - 1e6 / (510 * 510); }

  struct Layer {
    double share;
    std::complex<double> at_510;
    double slope;
    std::complex<double> index(double nm) const {
      return {at_510.real() + slope * bend(nm), at_510.imag() * (slope == 0 ? 1 : 510 / nm)};
    }
  };
  // Dielectrics, dark ones, and now and then a metal of a few nanometres.
  Layer layer(bool absorbs, bool disperses) {
    const double share = between(0.3, 1), slope = disperses ? between(0, 0.02) : 0;
    if (absorbs && chance(0.1)) return {0.1 * share, {between(0.1, 1), between(1, 4)}, slope};
    return {share, {between(1.3, 2.4), absorbs && chance(0.6) ? logarithmic(1e-3, 0.3) : 0}, slope};
  }
  void make_opaque(Material& m) {
    m.base_ior = between(0.1, 3);
    m.base_extinction = logarithmic(0.1, 5);
    m.albedo = Rgb(0);
    m.absorption_per_nm = m.scattering_per_nm = 0;
  }
};

}  // namespace sunbeam::test
