// An independent thin film for the tests: complex amplitudes in extended precision, the textbook way.
//
// t and r of each interface from Fresnel's equations with complex cosines, the infinite sum of reflections as
// a closed form, powers from |r|^2 and from |t|^2 n2 cos2 / (n0 cos0). Singular where the product's formula
// is not: at n0 sin = n1 exactly.
#pragma once

#include <complex>

namespace sunbeam::test {

struct AiryReference {
  long double reflectance = 0, transmittance = 0;  // unpolarised
};

inline AiryReference airy_reference(long double n0, long double n1, long double n2, long double thickness_nm,
                                    long double cos0, long double wavelength_nm) {
  using Complex = std::complex<long double>;
  // cos^2 = 1 - (n0/n)^2 (1 - cos0^2), arranged so that equal media keep a grazing cosine's digits.
  const auto cosine_in = [&](long double n) {
    return std::sqrt(Complex(((n - n0) * (n + n0) + n0 * n0 * cos0 * cos0) / (n * n)));
  };
  const Complex c0 = cos0, c1 = cosine_in(n1), c2 = cosine_in(n2);
  const long double turn = 2 * std::acos(-1.0L) * n1 * thickness_nm / wavelength_nm;  // half the phase / c1
  const Complex half = std::exp(Complex(0, 1) * turn * c1), round_trip = half * half;

  AiryReference power;
  for (const bool parallel : {false, true}) {
    // Interface a|b: r = (ya - yb) / (ya + yb) with y = n cos (s) or, for p, the cosines change places.
    const auto r = [&](long double na, Complex ca, long double nb, Complex cb) {
      return parallel ? (nb * ca - na * cb) / (nb * ca + na * cb) : (na * ca - nb * cb) / (na * ca + nb * cb);
    };
    const auto t = [&](long double na, Complex ca, long double nb, Complex cb) {
      return 2.0L * na * ca / (parallel ? nb * ca + na * cb : na * ca + nb * cb);
    };
    const Complex r01 = r(n0, c0, n1, c1), r12 = r(n1, c1, n2, c2);
    const Complex all = 1.0L + r01 * r12 * round_trip;
    const Complex reflected = (r01 + r12 * round_trip) / all;
    const Complex transmitted = t(n0, c0, n1, c1) * t(n1, c1, n2, c2) * half / all;
    power.reflectance += std::norm(reflected) / 2;
    power.transmittance += std::norm(transmitted) * (n2 * c2.real()) / (n0 * cos0) / 2;
  }
  return power;
}

// Bare interface n0|n2, unpolarised (Born and Wolf, sec. 1.5.2), real cosines: tan and sin forms avoided.
inline double fresnel_reference(double n0, double n2, double cos0) {
  const double sin2 = n0 / n2 * std::sqrt(1 - cos0 * cos0);
  if (sin2 >= 1) return 1;
  const double cos2 = std::sqrt(1 - sin2 * sin2);
  const double s = (n0 * cos0 - n2 * cos2) / (n0 * cos0 + n2 * cos2);
  const double p = (n2 * cos0 - n0 * cos2) / (n2 * cos0 + n0 * cos2);
  return (s * s + p * p) / 2;
}

}  // namespace sunbeam::test
