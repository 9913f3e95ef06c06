#include "bake/optics/thin_film.h"

#include <array>

#include "runtime/src/base/vector_clones.h"

namespace sunbeam {
namespace {

// The reference form: double precision, lanes are three wavelengths, side by side in fixed arrays that the
// compiler turns into vector instructions; the fourth lane repeats the third.
constexpr int kLanes = 4;
using Lanes = std::array<double, kLanes>;

// sin and cos for |x| < 1e6 to about 1e-16 + 1e-16 |x|: reduction to [-pi/4, pi/4] by pi/2 in three parts,
// then the Taylor-like minimax polynomials of fdlibm (Sun Microsystems 1993, k_sin.c, k_cos.c).
inline void sin_cos(const Lanes& x, Lanes& sine, Lanes& cosine) {
  constexpr double kRound = 0x1.8p52;  // adding and subtracting it rounds to the nearest integer
  for (int k = 0; k < kLanes; ++k) {
    const double n = (x[k] * (2 / kPi) + kRound) - kRound;
    const double r = ((x[k] - n * 0x1.921fb544p0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69;
    const double z = r * r;
    const double s =
        r + r * z *
                (-1.66666666666666324348e-01 +
                 z * (8.33333333332248946124e-03 +
                      z * (-1.98412698298579493134e-04 +
                           z * (2.75573137070700676789e-06 +
                                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    const double c =
        1 - 0.5 * z +
        z * z *
            (4.16666666666666019037e-02 +
             z * (-1.38888888888741095749e-03 +
                  z * (2.48015872894767294178e-05 +
                       z * (-2.75573143513906633035e-07 +
                            z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    // Quadrant 0 to 3 of n.
    const double quarter = n * 0.25;
    double floor_quarter = (quarter + kRound) - kRound;
    floor_quarter = floor_quarter > quarter ? floor_quarter - 1 : floor_quarter;
    const double quadrant = n - 4 * floor_quarter;
    const bool odd = quadrant == 1 || quadrant == 3;
    const double magnitude_s = odd ? c : s, magnitude_c = odd ? s : c;
    sine[k] = quadrant >= 2 ? -magnitude_s : magnitude_s;
    cosine[k] = quadrant == 1 || quadrant == 2 ? -magnitude_c : magnitude_c;
  }
}

// cos(k c1) and sin(k c1) / c1, both real for any sign of c1^2. Evanescent waves are returned divided by
// cosh(k |c1|), so that thick films do not overflow; `scale2` is the square of that divisor.
struct FilmPhase {
  Lanes cosine, sine_over_c1, scale2;
};

inline FilmPhase wave_phase(const Lanes& k, double c1) {
  FilmPhase phase;
  Lanes x, sine;
  for (int i = 0; i < kLanes; ++i) x[i] = k[i] * c1;
  sin_cos(x, sine, phase.cosine);
  for (int i = 0; i < kLanes; ++i) {
    phase.sine_over_c1[i] = sine[i] / c1;
    phase.scale2[i] = 1;
  }
  return phase;
}

FilmPhase evanescent_phase(const Lanes& k, double kappa) {
  FilmPhase phase;
  for (int i = 0; i < kLanes; ++i) {
    const double x = k[i] * kappa;
    phase.cosine[i] = 1;
    phase.sine_over_c1[i] = x < 1e-9 ? k[i] : std::tanh(x) / kappa;
    phase.scale2[i] = square(std::cosh(std::min(x, 350.0)));
  }
  return phase;
}

// Adds half of one polarisation. q0 q2 sin / q1 = b S and q1 sin = d S with S = sin / c1.
inline void add_polarisation(double q0, double q2, double b, double d, const FilmPhase& phase,
                             Lanes& reflectance, Lanes& transmittance) {
  for (int i = 0; i < kLanes; ++i) {
    const double s = phase.sine_over_c1[i], c = phase.cosine[i];
    const double denominator = square((q0 + q2) * c) + square((b + d) * s);
    const double half = 0.5 / denominator;
    reflectance[i] += half * (square((q0 - q2) * c) + square((b - d) * s));
    transmittance[i] += half * (4 * q0 * q2) / phase.scale2[i];
  }
}

SUNBEAM_VECTOR_CLONES
FilmPower transmitting_film(const ThinFilm& film, double c0, double c2, const Rgb& wavelengths_nm) {
  const double n0 = film.exterior_ior, n1 = film.film_ior, n2 = film.base_ior;
  const double c1_squared = refracted_cosine_squared(n0, n1, c0);
  const Lanes wavelength = {wavelengths_nm.r, wavelengths_nm.g, wavelengths_nm.b, wavelengths_nm.b};
  Lanes k;
  for (int i = 0; i < kLanes; ++i) k[i] = 2 * kPi * n1 * film.thickness_nm / wavelength[i];
  const FilmPhase phase = c1_squared > 1e-20 ? wave_phase(k, std::sqrt(c1_squared))
                                             : evanescent_phase(k, std::sqrt(std::max(0.0, -c1_squared)));
  Lanes reflectance{}, transmittance{};
  const double s0 = n0 * c0, s2 = n2 * c2, p0 = c0 / n0, p2 = c2 / n2;
  add_polarisation(s0, s2, s0 * s2 / n1, n1 * c1_squared, phase, reflectance, transmittance);
  add_polarisation(p0, p2, p0 * p2 * n1, c1_squared / n1, phase, reflectance, transmittance);
  return {{reflectance[0], reflectance[1], reflectance[2]},
          {transmittance[0], transmittance[1], transmittance[2]}};
}

}  // namespace

FilmPower airy(const ThinFilm& film, double cos_exterior, const Rgb& wavelengths_nm) {
  const double c2_squared = refracted_cosine_squared(film.exterior_ior, film.base_ior, cos_exterior);
  if (c2_squared <= 0 || cos_exterior <= 0) return {Rgb(1), Rgb(0)};
  return transmitting_film(film, cos_exterior, std::sqrt(c2_squared), wavelengths_nm);
}

}  // namespace sunbeam
