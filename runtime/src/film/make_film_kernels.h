// This file is included by one source file for each instruction set. Everything here is local to that file,
// and no library function is called: the linker must not take a copy from here for processors that cannot run
// it.
//
// Four doubles hold four cosines, V as many wavelengths as it has floats.
#pragma once

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"  // long vectors are returned by functions that are inlined only
#endif

#include <cstring>

#include "runtime/src/base/lanes.h"
#include "runtime/src/film/film_kernels.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kCosines = 4;
using Cosines = Doubles4;
using CosineBits = decltype(Cosines{} < Cosines{});

// Holds all that does not depend on the wavelength, for four cosines. Where X < 0 (n1 between n0 and n2), sum
// + X sin^2 would cancel at grazing. It is then written as (sum + X) - X cos^2, and sum + X as a square: (m_1
// + n0 c0 n2 c2)^2 / m_1, (n1^2 c0 c2 + n0 n2 m_1 / n1^2)^2 / m_1.
struct FilmAngles {
  float offset;                       // of the phase in turns: 0 for sin^2, 1/2 for cos^2
  Floats4 path, path_high, path_low;  // d sqrt(m_1), nm; the second has 12 bits, the third is the rest
  Floats4 sum_s, sum_p;               // (n0 c0 + n2 c2)^2, (n2 c0 + n0 c2)^2; plus X for cos^2
  Floats4 x_s, x_p;                   // X, X F_0 F_2; for cos^2 their negatives
  Floats4 half_t;                     // t / 2
};

// Prepares what needs no more than floats. Cosines pass where m2 > 0; the others get t = 0 and D = 1.
inline void prepare_powers(const FilmMedia& media, const Floats4& c0, const Floats4& m1, const Floats4& m2,
                           FilmAngles& angles) {
  const double n0 = media.exterior_ior, n1 = media.film_ior, n2 = media.base_ior;
  const float n0f = static_cast<float>(n0), n1_squared = static_cast<float>(n1 * n1),
              n2f = static_cast<float>(n2);
  const float per_n1_squared = 1 / n1_squared;
  const float x = static_cast<float>((n1 - n0) * (n1 + n0) * (n1 - n2) * (n1 + n2));
  const bool is_between = x < 0;
  angles.offset = is_between ? 0.5f : 0;

  const auto through = m2 > 0;
  const Floats4 zero = {}, one = zero + 1, per_m1 = 1 / m1;
  Floats4 q2;
  square_root(select(through, m2, zero), q2);
  const Floats4 q0 = n0f * c0, c2 = (1 / n2f) * q2;
  const Floats4 part = 1 - per_n1_squared * m1;  // beta^2 / n1^2
  const Floats4 x_s = (is_between ? -x : x) * per_m1, x_p = x_s * (c0 * c0 - part) * (c2 * c2 - part);
  Floats4 s = q0 + q2, p = n2f * c0 + n0f * c2, sum_scale = one;
  if (is_between) {
    s = m1 + q0 * q2;
    p = n1_squared * c0 * c2 + (n0f * n2f * per_n1_squared) * m1;
    sum_scale = per_m1;
  }
  angles.sum_s = select(through, s * s * sum_scale, one);
  angles.sum_p = select(through, p * p * sum_scale, one);
  angles.x_s = select(through, x_s, zero);
  angles.x_p = select(through, x_p, zero);
  angles.half_t = 2 * q0 * q2;
}

// Prepares all angles, in doubles up to the squared cosines and the path, whose digits cancel or turn many
// times. It is a call of its own: inlined, its constants would be spread over registers and spilled for lists
// that are short.
SUNBEAM_NOINLINE void prepare(const FilmMedia& media, const Cosines& c0, FilmAngles& angles) {
  const double n0 = media.exterior_ior, n1 = media.film_ior, n2 = media.base_ior;
  const Cosines q0 = n0 * c0, m0 = q0 * q0, zero = {};
  const Cosines film_m1 = (n1 - n0) * (n1 + n0) + m0, base_m2 = (n2 - n0) * (n2 + n0) + m0;
  const Cosines m1 = select(film_m1 > 1e-20, film_m1, zero + 1e-20);
  const Cosines m2 = select(c0 > 1e-9, base_m2, zero);

  Cosines q1;
  square_root(m1, q1);
  const Cosines path = media.thickness_nm * q1;
  const Cosines path_high = bits_as<Cosines>(bits_as<CosineBits>(path) & ~((1LL << 41) - 1));
  angles.path = convert<Floats4>(path);
  angles.path_high = convert<Floats4>(path_high);
  angles.path_low = convert<Floats4>(path - path_high);
  prepare_powers(media, convert<Floats4>(c0), convert<Floats4>(m1), convert<Floats4>(m2), angles);
}

// Returns the sums of the lanes that are equal modulo 4.
template <class V>
Floats4 quarters(const V& v) {
  if constexpr (sizeof v == sizeof(Floats4))
    return v;
  else if constexpr (sizeof v == sizeof(Floats8))
    return shuffle<0, 1, 2, 3>(v, v) + shuffle<4, 5, 6, 7>(v, v);
  else
    return quarters(shuffle<0, 1, 2, 3, 4, 5, 6, 7>(v, v) + shuffle<8, 9, 10, 11, 12, 13, 14, 15>(v, v));
}

// Returns the sums of the lanes of r, g and b; the last lane means nothing.
inline Floats4 sums(const Floats4& r, const Floats4& g, const Floats4& b) {
  const Floats4 rg = shuffle<0, 4, 1, 5>(r, g) + shuffle<2, 6, 3, 7>(r, g);
  const Floats4 bb = b + shuffle<2, 3, 2, 3>(b, b);
  return shuffle<0, 1, 4, 4>(rg, bb) + shuffle<2, 3, 5, 5>(rg, bb);
}

// Makes the kernels of one instruction set. V holds as many wavelengths as it has floats in a vector.
template <class V>
struct FilmFloats {
  static constexpr std::size_t kWidth = sizeof(V) / sizeof(float);

  static V load(const float* from) {
    V v;
    std::memcpy(&v, from, sizeof v);
    return v;
  }

  static V absolute(const V& v) {
    using Bits = decltype(v < v);
    return bits_as<V>(bits_as<Bits>(v) & 0x7fffffff);
  }

  // Returns sin^2 or cos^2(pi u) for the turns u = path per, both in two parts. Only the part of u beyond its
  // nearest integer matters, and that is exact: the product of the high parts has 24 bits.
  static V squared_wave(const FilmAngles& angles, int i, const V& per_high, const V& per_low) {
    constexpr float kRound = 0x1.8p23f;  // adding and subtracting it rounds to the nearest integer
    const V high = angles.path_high[i] * per_high;
    const V low = angles.path_low[i] * per_high + angles.path[i] * per_low;
    const V integer = ((high + low) + kRound) - kRound;
    const V f = angles.offset - absolute((high - integer) + low), g = f * f;
    // sin(pi f) / f, minimax in g on |f| <= 1/2, relative error 4e-8 as rounded here.
    const V sine =
        f * (3.1415927410125732f +
             g * (-5.167709827423096f +
                  g * (2.550069570541382f + g * (-0.5982413291931152f + g * 0.07755855470895767f))));
    return sine * sine;
  }

  // Returns T_k / (t / 2) = 1 / D_s + 1 / D_p of kWidth wavelengths at cosine i.
  static V passing(const FilmAngles& angles, int i, const V& per_high, const V& per_low) {
    const V s = squared_wave(angles, i, per_high, per_low);
    const V d_s = angles.sum_s[i] + angles.x_s[i] * s, d_p = angles.sum_p[i] + angles.x_p[i] * s;
    return (d_s + d_p) / (d_s * d_p);
  }

  static FloatRgb fold_one(const FilmWavelengths& wavelengths, const FilmAngles& angles, int i) {
    V r = {}, g = {}, b = {};
    for (std::size_t k = 0; k < wavelengths.count; k += kWidth) {
      const V power = passing(angles, i, load(&wavelengths.per_high[k]), load(&wavelengths.per_low[k]));
      r += power * load(&wavelengths.weight[0][k]);
      g += power * load(&wavelengths.weight[1][k]);
      b += power * load(&wavelengths.weight[2][k]);
    }
    const FloatRgb& total = wavelengths.total_weight;
    const Floats4 passed = angles.half_t[i] * sums(quarters(r), quarters(g), quarters(b));
    return {total.r - passed[0], total.g - passed[1], total.b - passed[2]};
  }

  static void fold(const FilmWavelengths& wavelengths, const FilmMedia& media, const float* cosines,
                   std::size_t count, FloatRgb* rgb) {
    FilmAngles angles;
    for (std::size_t first = 0; first < count; first += kCosines) {
      const std::size_t left = count - first;
      const float* c = cosines + first;
      prepare(media, Cosines{c[0], c[left > 1 ? 1 : 0], c[left > 2 ? 2 : 0], c[left > 3 ? 3 : 0]}, angles);
      for (int i = 0; i < kCosines && i < static_cast<int>(left); ++i)
        rgb[first + i] = fold_one(wavelengths, angles, i);
    }
  }

  static void transmittances(const FilmWavelengths& wavelengths, const FilmMedia& media, float cosine,
                             float* transmittance) {
    FilmAngles angles;
    prepare(media, Cosines{cosine, cosine, cosine, cosine}, angles);
    for (std::size_t k = 0; k < wavelengths.padded; k += kWidth) {
      const V t = angles.half_t[0] *
                  passing(angles, 0, load(&wavelengths.per_high[k]), load(&wavelengths.per_low[k]));
      std::memcpy(transmittance + k, &t, sizeof t);
    }
  }
};

template <class V>
constexpr FilmKernels film_kernels(const char* name) {
  return {name, FilmFloats<V>::fold, FilmFloats<V>::transmittances};
}

}  // namespace
}  // namespace v1
}  // namespace sunbeam
