#include "bake/optics/thin_film.h"

namespace sunbeam {
namespace {

// cos(k c1) and sin(k c1) / c1, both real for any sign of c1^2. Evanescent waves are returned divided by
// cosh(k |c1|), whose square comes along, so that thick films do not overflow.
struct FilmPhase {
  double cosine, sine_over_c1;
  double scale2;  // square of what the pair was divided by
};

FilmPhase film_phase(double k, double c1_squared) {
  if (c1_squared > 0) {
    const double c1 = std::sqrt(c1_squared);
    return {std::cos(k * c1), std::sin(k * c1) / c1, 1};
  }
  const double kappa = std::sqrt(-c1_squared);
  const double x = k * kappa;
  if (x < 1e-9) return {1, k, 1};
  return {1, std::tanh(x) / kappa, square(std::cosh(std::min(x, 350.0)))};
}

struct Powers {
  double reflectance, transmittance;
};

// One polarisation. `b` = q0 q2 sin / q1 and `d` = q1 sin of the header's formula.
Powers polarised(double q0, double q2, double b, double d, const FilmPhase& phase) {
  const double denominator = square((q0 + q2) * phase.cosine) + square(b + d);
  if (denominator == 0) return {1, 0};  // index-matched at exactly grazing incidence
  return {(square((q0 - q2) * phase.cosine) + square(b - d)) / denominator,
          4 * q0 * q2 / (denominator * phase.scale2)};
}

Powers unpolarised(const ThinFilm& film, double c0, double c1_squared, double c2, double wavelength_nm) {
  const double n1 = film.film_ior;
  const FilmPhase phase = film_phase(2 * kPi * n1 * film.thickness_nm / wavelength_nm, c1_squared);
  const double s0 = film.exterior_ior * c0, s2 = film.base_ior * c2;
  const double p0 = c0 / film.exterior_ior, p2 = c2 / film.base_ior;
  const Powers s =
      polarised(s0, s2, s0 * s2 * phase.sine_over_c1 / n1, n1 * c1_squared * phase.sine_over_c1, phase);
  const Powers p =
      polarised(p0, p2, p0 * p2 * n1 * phase.sine_over_c1, c1_squared * phase.sine_over_c1 / n1, phase);
  return {(s.reflectance + p.reflectance) / 2, (s.transmittance + p.transmittance) / 2};
}

}  // namespace

FilmPower airy(const ThinFilm& film, double cos_exterior, const Rgb& wavelengths_nm) {
  const double c2_squared = refracted_cosine_squared(film.exterior_ior, film.base_ior, cos_exterior);
  if (c2_squared <= 0) return {Rgb(1), Rgb(0)};
  const double c1_squared = refracted_cosine_squared(film.exterior_ior, film.film_ior, cos_exterior);
  const double c2 = std::sqrt(c2_squared);
  FilmPower power;
  for (int channel = 0; channel < 3; ++channel) {
    const Powers p = unpolarised(film, cos_exterior, c1_squared, c2, wavelengths_nm[channel]);
    power.reflectance[channel] = p.reflectance;
    power.transmittance[channel] = p.transmittance;
  }
  return power;
}

}  // namespace sunbeam
