// This file computes Airy's powers (bake/optics/thin_film.h has the equations and their letters) for the
// walks, in double precision. Lanes are directions; one wavelength comes after the other.
//
// FilmPackets serves single clear films; what a layered one does is looked up (look_up_film).
//
// All but the phase is shared by the wavelengths: x and y follow from cos(phi), phi = 2 k c1, alone, and by a
// recurrence where wavelengths have even phases. R and T are right to 1e-11, by the recurrence to 1e-10.
#pragma once

#include <array>

#include "bake/live/walks/packet.h"
#include "bake/optics/thin_film.h"
#include "sunbeam/detail/film_curves.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam::walk {

// Holds k = 2 pi n1 d0 / lambda of each wavelength; or, for a layered film, its curves and the numbers that
// the wavelengths have there.
struct FilmPhases {
  std::array<double, kMostWavelengths> k{};
  int count = 0;
  const FilmCurves* curves = nullptr;
  std::array<int, kMostWavelengths> number{};
  std::span<const int> numbers() const { return {number.data(), static_cast<std::size_t>(count)}; }
  bool is_bare = false;  // no film: k = 0 throughout
  bool is_even = false;  // k[j] = k[0] + j step

  double step() const { return k[1] - k[0]; }
};

// Holds one side of a film with all divisions by indices done: cos^2 in a medium = offset + slope cos^2
// outside.
struct FilmSide {
  explicit FilmSide(const ThinFilm& film)
      : n0(film.exterior_ior),
        n1(film.film_ior),
        n2(film.base_ior),
        per_n0(1 / n0),
        per_n1(1 / n1),
        per_n2(1 / n2),
        offset1((n1 - n0) * (n1 + n0) * square(per_n1)),
        slope1(square(n0 * per_n1)),
        offset2((n2 - n0) * (n2 + n0) * square(per_n2)),
        slope2(square(n0 * per_n2)) {}

  double n0, n1, n2, per_n0, per_n1, per_n2, offset1, slope1, offset2, slope2;
};

template <class V>
class FilmPackets {
 public:
  // Takes the cosines `c0` in the film's exterior; those <= 0 reflect everything.
  SUNBEAM_INLINE FilmPackets(const FilmSide& film, const FilmPhases& phases, const V& c0) : phases_(phases) {
    const V c2_squared = V(film.offset2) + squared(c0) * V(film.slope2);
    const auto through = (c2_squared > V(0)) & (c0 > V(0));
    through_ = select(through, V(1), V(0));
    const V c2 = select(through, sqrt(max(c2_squared, V(0))), V(1));  // anything but 0 / 0
    const V cosine = select(through, c0, V(1));
    if (phases.is_bare) {
      bare_polarisation(V(film.n0) * cosine, V(film.n2) * c2, s_);
      bare_polarisation(cosine * V(film.per_n0), c2 * V(film.per_n2), p_);
      return;
    }
    c1_squared_ = V(film.offset1) + squared(cosine) * V(film.slope1);
    polarisation(V(film.n0) * cosine, V(film.n2) * c2, V(film.per_n1), V(film.n1) * c1_squared_, s_);
    polarisation(cosine * V(film.per_n0), c2 * V(film.per_n2), V(film.n1), c1_squared_ * V(film.per_n1), p_);
    const V tiny(1e-12);
    may_be_evanescent_ = film.n1 < film.n0;
    c1_ = sqrt(may_be_evanescent_ ? max(max(c1_squared_, -c1_squared_), tiny) : max(c1_squared_, tiny));
    per_c1_squared_ = V(1) / squared(c1_);
  }

  // Returns 1 where the refracted squared cosine is positive, so that light gets through, else 0.
  SUNBEAM_INLINE V through() const { return through_; }

  // Calls visit(j, reflectance) for each wavelength.
  template <class F>
  SUNBEAM_INLINE void reflectances(F visit) const {
    each_phase(visit, [&](const V& c, const V& s, const V&) { return reflectance(c, s); });
  }
  // Returns the reflectance, each lane at a wavenumber k of its own; k = 0 if the film is bare.
  SUNBEAM_INLINE V reflectance_at(const V& k) const {
    const auto power = [&](const V& c, const V& s, const V&) { return reflectance(c, s); };
    if (phases_.is_bare) return power(V(1), V(0), V(1));
    if (may_be_evanescent_) return evanescent(k, power);
    return wave(cos_of_phase(V(2) * k * c1_), power);
  }
  template <class F>
  SUNBEAM_INLINE void transmittances(F visit) const {
    each_phase(visit, [&](const V& c, const V& s, const V& scale) {
      const V ds = s_.sum * c + s_.plus * s, dp = p_.sum * c + p_.plus * s;
      return through_ * scale * (s_.product * dp + p_.product * ds) / (ds * dp);
    });
  }

 private:
  SUNBEAM_INLINE V reflectance(const V& c, const V& s) const {
    const V ds = s_.sum * c + s_.plus * s, dp = p_.sum * c + p_.plus * s;
    const V ns = s_.difference * c + s_.minus * s, np = p_.difference * c + p_.minus * s;
    return V(1) + through_ * (V(0.5) * (ns * dp + np * ds) / (ds * dp) - V(1));
  }

  struct Polarisation {
    V sum, difference;  // (q0 +- q2)^2
    V plus, minus;      // (b +- d)^2
    V product;          // 2 q0 q2: half of 4 q0 q2
  };

  SUNBEAM_INLINE static void polarisation(const V& q0, const V& q2, const V& per_n, const V& d,
                                          Polarisation& p) {
    bare_polarisation(q0, q2, p);
    const V b = q0 * q2 * per_n;
    p.plus = squared(b + d);
    p.minus = squared(b - d);
  }
  SUNBEAM_INLINE static void bare_polarisation(const V& q0, const V& q2, Polarisation& p) {
    p = {squared(q0 + q2), squared(q0 - q2), V(0), V(0), V(2) * q0 * q2};
  }

  // Calls visit(j, power(x, y, 1 / cosh^2)) for each wavelength.
  template <class F, class Power>
  SUNBEAM_INLINE void each_phase(F& visit, Power power) const {
    const int count = phases_.count;
    if (phases_.is_bare) {
      const V same = power(V(1), V(0), V(1));
      for (int j = 0; j < count; ++j) visit(j, same);
    } else if (may_be_evanescent_) {
      for (int j = 0; j < count; ++j) visit(j, evanescent(V(phases_.k[j]), power));
    } else if (!phases_.is_even) {
      for (int j = 0; j < count; ++j) visit(j, wave(cos_of_phase(V(2 * phases_.k[j]) * c1_), power));
    } else {
      // cos((j + 1) x) = 2 cos(x) cos(j x) - cos((j - 1) x).
      const V twice = V(2) * cos_of_phase(V(2 * phases_.step()) * c1_);
      V previous = cos_of_phase(V(2 * (phases_.k[0] - phases_.step())) * c1_),
        current = cos_of_phase(V(2 * phases_.k[0]) * c1_);
      for (int j = 0; j < count; ++j) {
        visit(j, wave(current, power));
        const V next = twice * current - previous;
        previous = current;
        current = next;
      }
    }
  }

  template <class Power>
  SUNBEAM_INLINE V wave(const V& cosine, const Power& power) const {
    return power(V(0.5) + V(0.5) * cosine, (V(0.5) - V(0.5) * cosine) * per_c1_squared_, V(1));
  }
  // Takes k of each lane.
  template <class Power>
  SUNBEAM_INLINE V evanescent(const V& k, const Power& power) const {
    const V phase = V(2) * k * c1_;
    const auto is_wave = c1_squared_ > V(0);
    const V cosine = cos_of_phase(select(is_wave, phase, V(0)));
    const V e = exp_negative(-phase), tanh = (V(1) - e) / (V(1) + e);
    const V x = select(is_wave, V(0.5) + V(0.5) * cosine, V(1));
    const V y = select(is_wave, V(0.5) - V(0.5) * cosine, squared(tanh)) * per_c1_squared_;
    const V scale = select(is_wave, V(1), V(4) * e / squared(V(1) + e));
    // 1 - cos and 1 - e lose the digits of a small phase, and per_c1_squared_ magnifies that. The series of
    // (1 - cos) / 2 serves both sides of c1 = 0, where x and y go on as cosh^2 and sinh^2 / |c1|^2.
    const V z = V(4) * squared(k) * c1_squared_;  // phase^2
    const auto is_small = V(0.01) > max(z, -z);
    const V small_y = squared(k) * (V(1) - z * (V(1.0 / 12) - z * (V(1.0 / 360) - z * V(1.0 / 20160))));
    return power(select(is_small, V(1) - small_y * c1_squared_, x), select(is_small, small_y, y),
                 select(is_small, V(1), scale));
  }

  const FilmPhases& phases_;
  Polarisation s_, p_;
  V through_, c1_squared_, c1_, per_c1_squared_;
  bool may_be_evanescent_ = false;
};

// Holds one power a wavelength.
template <class V>
using Spectrum = std::array<V, kMostWavelengths>;

// Writes the powers of a layered film for light on the side that `is_inside`, 1 or 0, says.
template <class V>
__attribute__((noinline)) void look_up_film(const FilmPhases& phases, const V& is_inside, const V& cosine,
                                            Spectrum<V>& r, Spectrum<V>& t) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(double);
  std::array<double, kWidth> inside, at;
  std::array<double, kWidth * kMostWavelengths> reflectance, transmittance;
  __builtin_memcpy(inside.data(), &is_inside, sizeof(V));
  __builtin_memcpy(at.data(), &cosine, sizeof(V));
  phases.curves->at(inside.data(), at, phases.numbers(), reflectance.data(), transmittance.data());
  __builtin_memcpy(r.data(), reflectance.data(), phases.count * sizeof(V));
  __builtin_memcpy(t.data(), transmittance.data(), phases.count * sizeof(V));
}

}  // namespace sunbeam::walk
