#include "bake/optics/fringes.h"

#include <array>

#include "runtime/src/base/vector_clones.h"

namespace sunbeam {
namespace {

constexpr std::size_t kLanes = 8;
// sin^2 is divided by the film's own cos^2, so that its rounding errors grow towards the film's critical
// angle: in the powers by at most 1 / kNearCritical beyond the neighbourhood that this bounds. A film whose
// index is above that of either neighbour never comes there.
constexpr double kNearCritical = 0.01;

// One polarisation's (q0 +- q2)^2, (b +- d)^2 / c1^2 and 2 q0 q2, in the letters of thin_film.h.
struct Polarisation {
  double sum, difference, plus, minus, product;
};

Polarisation polarisation(double q0, double q2, double per_n, double d, double c1_squared) {
  const double b = q0 * q2 * per_n;
  return {square(q0 + q2), square(q0 - q2), square(b + d) / c1_squared, square(b - d) / c1_squared,
          2 * q0 * q2};
}

// The phase of lane l at step i is first + (i kLanes + l) step.
SUNBEAM_VECTOR_CLONES
void add_waves(const Polarisation& s, const Polarisation& p, double first, double step, double* reflectance,
               double* transmittance, std::size_t count) {
  std::array<double, kLanes> re, im;
  for (std::size_t l = 0; l < kLanes; ++l) {
    re[l] = std::cos(first + static_cast<double>(l) * step);
    im[l] = std::sin(first + static_cast<double>(l) * step);
  }
  const double turn_re = std::cos(kLanes * step), turn_im = std::sin(kLanes * step);
  for (std::size_t j = 0; j < count; j += kLanes) {
    std::array<double, kLanes> r, t;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double c = 0.5 + 0.5 * re[l], sine = 0.5 - 0.5 * re[l];
      const double ds = s.sum * c + s.plus * sine, dp = p.sum * c + p.plus * sine;
      const double ns = s.difference * c + s.minus * sine, np = p.difference * c + p.minus * sine;
      const double per_d = 1 / (ds * dp);
      r[l] = 0.5 * (ns * dp + np * ds) * per_d;
      t[l] = (s.product * dp + p.product * ds) * per_d;
      const double next = re[l] * turn_re - im[l] * turn_im;
      im[l] = re[l] * turn_im + im[l] * turn_re;
      re[l] = next;
    }
    for (std::size_t l = 0; l < kLanes && j + l < count; ++l) {
      reflectance[j + l] = r[l];
      transmittance[j + l] = t[l];
    }
  }
}

// The same where the wave is evanescent: cos^2 and sin^2 become cosh^2 and -sinh^2, here over cosh^2.
// `first` and `step` are of the phase's absolute value.
void add_evanescent(const Polarisation& s, const Polarisation& p, double first, double step,
                    std::span<double> reflectance, std::span<double> transmittance) {
  for (std::size_t j = 0; j < reflectance.size(); ++j) {
    const double e = std::exp(-(first + static_cast<double>(j) * step));
    const double tanh2 = square((1 - e) / (1 + e)), per_cosh2 = 4 * e / square(1 + e);
    const double ds = s.sum - s.plus * tanh2, dp = p.sum - p.plus * tanh2;
    const double ns = s.difference - s.minus * tanh2, np = p.difference - p.minus * tanh2;
    const double per_d = 1 / (ds * dp);
    reflectance[j] = 0.5 * (ns * dp + np * ds) * per_d;
    transmittance[j] = (s.product * dp + p.product * ds) * per_d * per_cosh2;
  }
}

}  // namespace

void film_fringes(const ThinFilm& film, double cosine, double first, double step,
                  std::span<double> reflectance, std::span<double> transmittance) {
  const double c1_squared = refracted_cosine_squared(film.exterior_ior, film.film_ior, cosine);
  const double c2_squared = refracted_cosine_squared(film.exterior_ior, film.base_ior, cosine);
  if (c2_squared <= 0 || cosine <= 0) {
    std::fill(reflectance.begin(), reflectance.end(), 1.0);
    std::fill(transmittance.begin(), transmittance.end(), 0.0);
    return;
  }
  const double n0 = film.exterior_ior, n1 = film.film_ior, n2 = film.base_ior;
  if (square(n1) * std::abs(c1_squared) <=
      kNearCritical * std::min(square(n0 * cosine), square(n2) * c2_squared)) {
    for (std::size_t j = 0; j < reflectance.size(); ++j) {
      ThinFilm thick = film;
      thick.thickness_nm = first + static_cast<double>(j) * step;
      const FilmPower power = airy(thick, cosine, Rgb(1));
      reflectance[j] = power.reflectance.r;
      transmittance[j] = power.transmittance.r;
    }
    return;
  }
  const double c1 = std::sqrt(std::abs(c1_squared)), c2 = std::sqrt(c2_squared);
  // Here b and d carry one more c1 each than in thin_film.h, and add_waves() takes sin^2 for y.
  const Polarisation s = polarisation(n0 * cosine, n2 * c2, 1 / n1, n1 * c1_squared, c1_squared);
  const Polarisation p = polarisation(cosine / n0, c2 / n2, n1, c1_squared / n1, c1_squared);
  const double phase = 4 * kPi * n1 * c1;
  if (c1_squared < 0) return add_evanescent(s, p, phase * first, phase * step, reflectance, transmittance);
  add_waves(s, p, phase * first, phase * step, reflectance.data(), transmittance.data(), reflectance.size());
}

}  // namespace sunbeam
