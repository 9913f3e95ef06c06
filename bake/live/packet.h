// Sixteen numbers worked on side by side: the lanes of a packet are independent walks.
//
// A thin layer over xsimd that keeps the number of lanes whatever the width of the machine's registers, so
// that every instruction set gives the same bits (none of those used fuses multiplications and additions).
// The same templates also run on plain double: one lane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

#include "sunbeam/core/rng.h"
#include "sunbeam/core/vec.h"

namespace sunbeam::walk {

inline constexpr int kLanes = 16;

// Everything is inlined into the kernels, so that no copy compiled for one instruction set can stand in for
// another's. Sanitizers would spend minutes on such functions.
#ifdef __SANITIZE_ADDRESS__
#define SUNBEAM_INLINE inline
#define SUNBEAM_FLATTEN
#else
#define SUNBEAM_INLINE [[gnu::always_inline]] inline
#define SUNBEAM_FLATTEN [[gnu::flatten]]
#endif

// sum_k c_k x^k of ten or twelve terms, in pairs (Estrin): a third of the waiting of Horner's scheme.
template <class V, std::size_t kTerms>
SUNBEAM_INLINE V polynomial(const double (&c)[kTerms], const V& x) {
  static_assert(kTerms == 10 || kTerms == 12);
  const V x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  const auto pair = [&](int k) { return V(c[k]) + V(c[k + 1]) * x; };
  V top = pair(8);
  if constexpr (kTerms == 12) top = top + pair(10) * x2;
  return ((pair(0) + pair(2) * x2) + (pair(4) + pair(6) * x2) * x4) + top * x8;
}

// exp(x) for x <= 0, to 1e-14 relative; 1e-304 below -700. The library's exp converts to integers lane by
// lane before AVX-512. 2^n e^r with |r| <= ln(2) / 2, Taylor's series for e^r, n put into the exponent bits.
template <class Arch>
SUNBEAM_INLINE xsimd::batch<double, Arch> exp_negative(const xsimd::batch<double, Arch>& x) {
  using Batch = xsimd::batch<double, Arch>;
  using Bits = xsimd::batch<std::int64_t, Arch>;
  const Batch round(0x1.8p52 + 1023), clamped = xsimd::max(x, Batch(-700));
  const Batch shifted = clamped * Batch(std::numbers::log2e) + round;  // low bits: n + 1023
  const Batch n = shifted - round;
  const Batch r = (clamped - n * Batch(0x1.62e42feep-1)) - n * Batch(0x1.a39ef35793c76p-33);
  constexpr double kTerm[] = {
      1,         1,          1.0 / 2,     1.0 / 6,      1.0 / 24,      1.0 / 120,
      1.0 / 720, 1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800};
  const Batch sum = polynomial<Batch>(kTerm, r);
  return sum * xsimd::bitwise_cast<Batch>(xsimd::bitwise_cast<Bits>(shifted) << 52);
}

// ln(x) for 0 < x <= 1, to 1e-15 relative; about -709 at 0. x = 2^k m with m in [1/sqrt(2), sqrt(2)), then
// ln(m) = 2 artanh((m - 1) / (m + 1)) by its series; k leaves the exponent bits by way of 2^52 + k.
template <class Arch>
SUNBEAM_INLINE xsimd::batch<double, Arch> log_of_share(const xsimd::batch<double, Arch>& x) {
  using Batch = xsimd::batch<double, Arch>;
  using Bits = xsimd::batch<std::uint64_t, Arch>;
  constexpr std::uint64_t kLeast = 0x3fe6a09e667f3bcd;  // 1 / sqrt(2)
  const Bits shifted = xsimd::bitwise_cast<Bits>(x) + Bits(0x3ff0000000000000 - kLeast);
  const Batch k =
      xsimd::bitwise_cast<Batch>((shifted >> 52) | Bits(0x4330000000000000)) - Batch(0x1p52 + 1023);
  const Batch m = xsimd::bitwise_cast<Batch>((shifted & Bits(0x000fffffffffffff)) + Bits(kLeast));
  const Batch s = (m - Batch(1)) / (m + Batch(1));
  constexpr double kTerm[] = {2,        2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,
                              2.0 / 11, 2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19};
  return k * Batch(std::numbers::ln2) + s * polynomial<Batch>(kTerm, s * s);
}

// Two halves, each a batch or again two halves: members, not an array, so that compilers keep them in
// registers.
template <class Arch, int kCount = kLanes>
struct Packet {
  using Batch = xsimd::batch<double, Arch>;
  using Register = typename Batch::register_type;
  static constexpr int kHalf = kCount / 2;
  static_assert(static_cast<int>(Batch::size) <= kHalf);
  static constexpr bool kIsPair = static_cast<int>(Batch::size) == kHalf;
  using Half = typename std::conditional_t<kIsPair, std::type_identity<Batch>,
                                           std::type_identity<Packet<Arch, kHalf>>>::type;

  Half low, high;

  Packet() = default;
  SUNBEAM_INLINE Packet(double value) : low(value), high(value) {}
  SUNBEAM_INLINE Packet(const Half& l, const Half& h) : low(l), high(h) {}

  // f(0), f(1), ...; not by way of memory, which would wait for many small stores.
  template <class F>
  SUNBEAM_INLINE static Packet generate(F f) {
    if constexpr (!kIsPair)
      return {Half::generate(f), Half::generate([&](int lane) { return f(lane + kHalf); })};
    else if constexpr (kHalf == 2)
      return {Register{f(0), f(1)}, Register{f(2), f(3)}};
    else
      return {Register{f(0), f(1), f(2), f(3)}, Register{f(4), f(5), f(6), f(7)}};
  }
  SUNBEAM_INLINE static Packet load(const double* v) { return {load_half(v), load_half(v + kHalf)}; }
  SUNBEAM_INLINE void store(double* v) const {
    if constexpr (kIsPair) {
      low.store_unaligned(v);
      high.store_unaligned(v + kHalf);
    } else {
      low.store(v);
      high.store(v + kHalf);
    }
  }

  SUNBEAM_INLINE friend Packet operator+(const Packet& a, const Packet& b) {
    return {a.low + b.low, a.high + b.high};
  }
  SUNBEAM_INLINE friend Packet operator-(const Packet& a, const Packet& b) {
    return {a.low - b.low, a.high - b.high};
  }
  SUNBEAM_INLINE friend Packet operator*(const Packet& a, const Packet& b) {
    return {a.low * b.low, a.high * b.high};
  }
  SUNBEAM_INLINE friend Packet operator/(const Packet& a, const Packet& b) {
    return {a.low / b.low, a.high / b.high};
  }
  SUNBEAM_INLINE friend Packet operator-(const Packet& a) { return Packet(0) - a; }
  SUNBEAM_INLINE Packet& operator+=(const Packet& o) { return *this = *this + o; }
  SUNBEAM_INLINE Packet& operator*=(const Packet& o) { return *this = *this * o; }

  struct Mask {
    decltype(std::declval<Half>() > std::declval<Half>()) low, high;
    SUNBEAM_INLINE friend Mask operator&(const Mask& a, const Mask& b) {
      return {a.low & b.low, a.high & b.high};
    }
  };
  SUNBEAM_INLINE friend Mask operator>(const Packet& a, const Packet& b) {
    return {a.low > b.low, a.high > b.high};
  }
  SUNBEAM_INLINE friend Mask operator>=(const Packet& a, const Packet& b) {
    return {a.low >= b.low, a.high >= b.high};
  }
  SUNBEAM_INLINE friend Packet select(const Mask& mask, const Packet& yes, const Packet& no) {
    return {select(mask.low, yes.low, no.low), select(mask.high, yes.high, no.high)};
  }
  SUNBEAM_INLINE friend Packet sqrt(const Packet& a) { return {sqrt(a.low), sqrt(a.high)}; }
  SUNBEAM_INLINE friend Packet exp_negative(const Packet& a) {
    return {exp_negative(a.low), exp_negative(a.high)};
  }
  SUNBEAM_INLINE friend Packet log_of_share(const Packet& a) {
    return {log_of_share(a.low), log_of_share(a.high)};
  }
  SUNBEAM_INLINE friend Packet max(const Packet& a, const Packet& b) {
    return {max(a.low, b.low), max(a.high, b.high)};
  }
  SUNBEAM_INLINE friend Packet min(const Packet& a, const Packet& b) {
    return {min(a.low, b.low), min(a.high, b.high)};
  }

  // The same order of additions on every machine.
  SUNBEAM_INLINE friend double mean_of_lanes(const Packet& a) {
    double v[kCount];
    a.store(v);
    double sum = 0;
    for (int i = 0; i < kCount / 2; ++i) sum += v[i] + v[i + kCount / 2];
    return sum / kCount;
  }

 private:
  SUNBEAM_INLINE static Half load_half(const double* v) {
    if constexpr (kIsPair)
      return Batch::load_unaligned(v);
    else
      return Half::load(v);
  }
};

// One lane.
using std::max, std::min, std::sqrt;
SUNBEAM_INLINE double exp_negative(double x) { return std::exp(x); }
SUNBEAM_INLINE double select(bool mask, double yes, double no) { return mask ? yes : no; }
SUNBEAM_INLINE double mean_of_lanes(double a) { return a; }

template <class V>
SUNBEAM_INLINE V squared(const V& x) {
  return x * x;
}

// cos(pi u) for u in [0, 1]: Taylor's sine of pi (1/2 - u), exact to 1e-13.
template <class V>
SUNBEAM_INLINE V cos_half_turn(const V& u) {
  const V x = V(0.5) - u;
  constexpr double kTerm[] = {3.14159265358979324,     -5.16771278004997003,    2.55016403987734544,
                              -0.599264529320792077,   0.0821458866111282288,   -0.00737043094571435073,
                              4.66302805767612567e-04, -2.1915353447830216e-05, 7.95205400147551e-07,
                              -2.2948428997269873e-08};
  return polynomial<V>(kTerm, x * x) * x;
}

// cos(x) for |x| < 1e6, to 1e-13 + 1e-16 |x|: reduced by pi in three parts, then Taylor's series.
template <class V>
SUNBEAM_INLINE V cos_of_phase(const V& x) {
  const V round(0x1.8p52);  // adding and subtracting it rounds to the nearest integer
  const V n = (x * V(kInvPi) + round) - round;
  const V r = ((x - n * V(0x1.921fb544p1)) - n * V(0x1.0b4611a6p-33)) - n * V(0x1.3198a2e037073p-68);
  constexpr double kTerm[] = {1,
                              -1.0 / 2,
                              1.0 / 24,
                              -1.0 / 720,
                              1.0 / 40320,
                              -1.0 / 3628800,
                              1.0 / 479001600,
                              -1.0 / 87178291200,
                              1.0 / 20922789888000,
                              -1.0 / 6402373705728000};
  const V sum = polynomial<V>(kTerm, r * r);
  const V half = n * V(0.5), odd = half - ((half + round) - round);  // 0 or +-1/2
  return sum * (V(1) - V(8) * squared(odd));
}

// Rows of numbers that lie one in each of kLanes equal parts of [0, 1), in random order; see Uniform.
inline constexpr std::uint32_t kStrata = 64;
extern const std::array<std::array<double, kLanes>, kStrata> kStratum;

// One uniform number in [0, 1) a lane. A random shift makes each lane uniform by itself; the rows spread the
// lanes over the interval and match successive dimensions anew.
template <class V>
struct Uniform {
  SUNBEAM_INLINE static V draw(Rng& rng) {
    const std::uint32_t shift = rng.next();
    const V u = V::load(kStratum[shift % kStrata].data()) + V(shift * 0x1p-32);
    return select(u >= V(1), u - V(1), u);
  }
};
template <>
struct Uniform<double> {
  SUNBEAM_INLINE static double draw(Rng& rng) { return rng.uniform(); }
};

}  // namespace sunbeam::walk
