// This file works on sixteen numbers side by side: the lanes of a packet are independent walks.
//
// Packets are made of the compiler's vectors (GCC and Clang) and keep the number of lanes whatever the width
// of the machine's registers, so that every instruction set gives the same bits (none of those used fuses
// multiplications and additions). The same templates also run on plain double: one lane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <type_traits>

#include "runtime/src/base/vector_clones.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/core/vec.h"

namespace sunbeam::walk {

inline constexpr int kLanes = 16;

// These describe an instruction set by its registers. Its name is part of every kernel's, which keeps the
// linker from merging copies for different processors.
struct Baseline {  // what every machine has (x86-64: SSE2, Arm: NEON)
  static constexpr int kWidth = 2;
  using Register = double __attribute__((vector_size(16)));
  using Bits = std::uint64_t __attribute__((vector_size(16)));
};
struct Avx2 {
  static constexpr int kWidth = 4;
  using Register = double __attribute__((vector_size(32)));
  using Bits = std::uint64_t __attribute__((vector_size(32)));
};

// Returns sum_k c_k x^k of ten or twelve terms, in pairs (Estrin): this waits a third of what Horner's scheme
// does.
template <class V, std::size_t kTerms>
SUNBEAM_INLINE V polynomial(const double (&c)[kTerms], const V& x) {
  static_assert(kTerms == 10 || kTerms == 12);
  const V x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  const auto pair = [&](int k) { return V(c[k]) + V(c[k + 1]) * x; };
  V top = pair(8);
  if constexpr (kTerms == 12) top = top + pair(10) * x2;
  return ((pair(0) + pair(2) * x2) + (pair(4) + pair(6) * x2) * x4) + top * x8;
}

// Holds the numbers of one register.
template <class Arch>
struct Batch {
  static constexpr int kCount = Arch::kWidth;
  using Register = typename Arch::Register;
  using Bits = typename Arch::Bits;

  Register v;

  Batch() = default;
  SUNBEAM_INLINE Batch(double value) : v(value - Register{}) {}
  SUNBEAM_INLINE Batch(const Register& r) : v(r) {}

  template <class F>
  SUNBEAM_INLINE static Batch generate(F f) {
    if constexpr (kCount == 2)
      return Register{f(0), f(1)};
    else
      return Register{f(0), f(1), f(2), f(3)};
  }
  SUNBEAM_INLINE static Batch load(const double* from) {
    Batch p;
    __builtin_memcpy(&p.v, from, sizeof p.v);
    return p;
  }
  SUNBEAM_INLINE void store(double* to) const { __builtin_memcpy(to, &v, sizeof v); }

  SUNBEAM_INLINE friend Batch operator+(const Batch& a, const Batch& b) { return a.v + b.v; }
  SUNBEAM_INLINE friend Batch operator-(const Batch& a, const Batch& b) { return a.v - b.v; }
  SUNBEAM_INLINE friend Batch operator*(const Batch& a, const Batch& b) { return a.v * b.v; }
  SUNBEAM_INLINE friend Batch operator/(const Batch& a, const Batch& b) { return a.v / b.v; }
  SUNBEAM_INLINE friend Batch operator-(const Batch& a) { return Batch(0) - a; }

  struct Mask {
    decltype(Register{} > Register{}) bits;
    SUNBEAM_INLINE friend Mask operator&(const Mask& a, const Mask& b) { return {a.bits & b.bits}; }
  };
  SUNBEAM_INLINE friend Mask operator>(const Batch& a, const Batch& b) { return {a.v > b.v}; }
  SUNBEAM_INLINE friend Mask operator>=(const Batch& a, const Batch& b) { return {a.v >= b.v}; }
  SUNBEAM_INLINE friend Batch select(const Mask& mask, const Batch& yes, const Batch& no) {
    return mask.bits ? yes.v : no.v;
  }
  SUNBEAM_INLINE friend Batch max(const Batch& a, const Batch& b) { return a.v > b.v ? a.v : b.v; }
  SUNBEAM_INLINE friend Batch min(const Batch& a, const Batch& b) { return a.v < b.v ? a.v : b.v; }
  SUNBEAM_INLINE friend Batch sqrt(const Batch& a) {
    return generate([&](int lane) { return __builtin_sqrt(a.v[lane]); });
  }

  // Returns exp(x) for x <= 0, to 1e-14 relative; 1e-304 below -700. x = n ln(2) + r with |r| <= ln(2) / 2,
  // Taylor's series for e^r, and n goes into the exponent bits.
  SUNBEAM_INLINE friend Batch exp_negative(const Batch& x) {
    const Batch round(0x1.8p52 + 1023), clamped = max(x, Batch(-700));
    const Batch shifted = clamped * Batch(std::numbers::log2e) + round;  // low bits: n + 1023
    const Batch n = shifted - round;
    const Batch r = (clamped - n * Batch(0x1.62e42feep-1)) - n * Batch(0x1.a39ef35793c76p-33);
    constexpr double kTerm[] = {
        1,         1,          1.0 / 2,     1.0 / 6,      1.0 / 24,      1.0 / 120,
        1.0 / 720, 1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800};
    return polynomial<Batch>(kTerm, r) * Batch((Register)((Bits)shifted.v << 52));
  }

  // Returns ln(x) for 0 < x <= 1, to 1e-15 relative; about -709 at 0. x = 2^k m with m in [1/sqrt(2),
  // sqrt(2)), then ln(m) = 2 artanh((m - 1) / (m + 1)) by its series; k leaves the exponent bits by way of
  // 2^52 + k.
  SUNBEAM_INLINE friend Batch log_of_share(const Batch& x) {
    constexpr std::uint64_t kLeast = 0x3fe6a09e667f3bcd;  // 1 / sqrt(2)
    const Bits shifted = (Bits)x.v + (0x3ff0000000000000 - kLeast);
    const Batch k = Batch((Register)((shifted >> 52) | 0x4330000000000000)) - Batch(0x1p52 + 1023);
    const Batch m = (Register)((shifted & 0x000fffffffffffff) + kLeast);
    const Batch s = (m - Batch(1)) / (m + Batch(1));
    constexpr double kTerm[] = {2,        2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,
                                2.0 / 11, 2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19};
    return k * Batch(std::numbers::ln2) + s * polynomial<Batch>(kTerm, s * s);
  }
};

// Holds two halves, each a batch or again two halves. They are members, not an array, so that compilers keep
// them in registers.
template <class Arch, int kCount = kLanes>
struct Packet {
  static constexpr int kHalf = kCount / 2;
  using Half = std::conditional_t<kHalf == Arch::kWidth, Batch<Arch>, Packet<Arch, kHalf>>;

  Half low, high;

  Packet() = default;
  SUNBEAM_INLINE Packet(double value) : low(value), high(value) {}
  SUNBEAM_INLINE Packet(const Half& l, const Half& h) : low(l), high(h) {}

  // Returns f(0), f(1), ... It does not go by way of memory, which would wait for many small stores.
  template <class F>
  SUNBEAM_INLINE static Packet generate(F f) {
    return {Half::generate(f), Half::generate([&](int lane) { return f(lane + kHalf); })};
  }
  SUNBEAM_INLINE static Packet load(const double* v) { return {Half::load(v), Half::load(v + kHalf)}; }
  SUNBEAM_INLINE void store(double* v) const {
    low.store(v);
    high.store(v + kHalf);
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
    typename Half::Mask low, high;
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

  // The order of additions is the same on every machine.
  SUNBEAM_INLINE friend double mean_of_lanes(const Packet& a) {
    double v[kCount];
    a.store(v);
    double sum = 0;
    for (int i = 0; i < kCount / 2; ++i) sum += v[i] + v[i + kCount / 2];
    return sum / kCount;
  }
};

// These are the same functions for one lane.
using std::max, std::min, std::sqrt;
SUNBEAM_INLINE double exp_negative(double x) { return std::exp(x); }
SUNBEAM_INLINE double select(bool mask, double yes, double no) { return mask ? yes : no; }
SUNBEAM_INLINE double mean_of_lanes(double a) { return a; }

template <class V>
SUNBEAM_INLINE V squared(const V& x) {
  return x * x;
}

// Returns cos(pi u) for u in [0, 1] by Taylor's sine of pi (1/2 - u), exact to 1e-13.
template <class V>
SUNBEAM_INLINE V cos_half_turn(const V& u) {
  const V x = V(0.5) - u;
  constexpr double kTerm[] = {3.14159265358979324,     -5.16771278004997003,    2.55016403987734544,
                              -0.599264529320792077,   0.0821458866111282288,   -0.00737043094571435073,
                              4.66302805767612567e-04, -2.1915353447830216e-05, 7.95205400147551e-07,
                              -2.2948428997269873e-08};
  return polynomial<V>(kTerm, x * x) * x;
}

// Returns cos(x) for |x| < 1e6, to 1e-13 + 1e-16 |x|: x is reduced by pi in three parts, then Taylor's series
// follows.
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

// Each row holds numbers that lie one in each of kLanes equal parts of [0, 1), in random order; see Uniform.
inline constexpr std::uint32_t kStrata = 64;
extern const std::array<std::array<double, kLanes>, kStrata> kStratum;

// Draws one uniform number in [0, 1) a lane. A random shift makes each lane uniform by itself; the rows
// spread the lanes over the interval and match successive dimensions anew.
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
