// This file computes with several numbers at once, a lane each. They are vectors of GCC's kind, or with
// SUNBEAM_PORTABLE arrays of plain C++, which give the same bits. Operators work lane by lane and take a
// number for all lanes; comparisons give integers, -1 where they hold and 0 elsewhere.
#pragma once

#include "runtime/src/base/compiler.h"

#ifdef SUNBEAM_PORTABLE
#include <bit>
#include <cmath>
#include <cstddef>
#include <type_traits>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace sunbeam {
inline namespace v1 {

#ifdef SUNBEAM_PORTABLE

template <class T, int kCount>
struct Lanes {
  using Mask = Lanes<std::conditional_t<sizeof(T) == 8, long long, int>, kCount>;

  Lanes() = default;
  Lanes(T all) {
    for (T& x : lane) x = all;
  }
  template <class... Ts>
  requires(sizeof...(Ts) == kCount) Lanes(Ts... x) : lane{static_cast<T>(x)...} {}

  T& operator[](std::size_t k) { return lane[k]; }
  const T& operator[](std::size_t k) const { return lane[k]; }

  // Returns what f makes of each lane of a and b.
  template <class Result = Lanes, class F>
  static Result each(const Lanes& a, const Lanes& b, F f) {
    Result result;
    for (std::size_t k = 0; k < kCount; ++k) result[k] = f(a[k], b[k]);
    return result;
  }
  friend Lanes operator+(const Lanes& a, const Lanes& b) {
    return each(a, b, [](T x, T y) { return x + y; });
  }
  friend Lanes operator-(const Lanes& a, const Lanes& b) {
    return each(a, b, [](T x, T y) { return x - y; });
  }
  friend Lanes operator*(const Lanes& a, const Lanes& b) {
    return each(a, b, [](T x, T y) { return x * y; });
  }
  friend Lanes operator/(const Lanes& a, const Lanes& b) {
    return each(a, b, [](T x, T y) { return x / y; });
  }
  friend Lanes operator&(const Lanes& a, const Lanes& b) {
    return each(a, b, [](T x, T y) { return x & y; });
  }
  friend Lanes operator^(const Lanes& a, const Lanes& b) {
    return each(a, b, [](T x, T y) { return x ^ y; });
  }
  friend Lanes operator<<(const Lanes& a, const Lanes& b) {
    return each(a, b, [](T x, T y) { return x << y; });
  }
  friend Mask operator<(const Lanes& a, const Lanes& b) {
    return each<Mask>(a, b, [](T x, T y) { return x < y ? -1 : 0; });
  }
  friend Mask operator>(const Lanes& a, const Lanes& b) { return b < a; }
  Lanes& operator+=(const Lanes& o) { return *this = *this + o; }
  Lanes& operator-=(const Lanes& o) { return *this = *this - o; }

  T lane[kCount];
};

using Floats4 = Lanes<float, 4>;
using Floats8 = Lanes<float, 8>;
using Floats16 = Lanes<float, 16>;
using Doubles2 = Lanes<double, 2>;
using Doubles4 = Lanes<double, 4>;
using Ints4 = Lanes<int, 4>;

// Takes the lanes of a where the mask holds, of b elsewhere.
template <class V>
V select(const typename V::Mask& mask, const V& a, const V& b) {
  V result;
  for (std::size_t k = 0; k < sizeof(V) / sizeof(V{}[0]); ++k) result[k] = mask[k] ? a[k] : b[k];
  return result;
}

// Returns the same numbers in another type; integers are cut off towards 0.
template <class To, class T, int kCount>
To convert(const Lanes<T, kCount>& from) {
  To result;
  for (std::size_t k = 0; k < kCount; ++k)
    result[k] = static_cast<std::decay_t<decltype(result[k])>>(from[k]);
  return result;
}

// Returns the same bits in another type.
template <class To, class From>
To bits_as(const From& from) {
  return std::bit_cast<To>(from);
}

// Picks lanes of a and b, numbered one after the other.
template <int... kLane, class T, int kCount>
Lanes<T, sizeof...(kLane)> shuffle(const Lanes<T, kCount>& a, const Lanes<T, kCount>& b) {
  return {(kLane < kCount ? a[kLane % kCount] : b[kLane % kCount])...};
}

template <class V>
void square_root(const V& x, V& root) {
  for (std::size_t k = 0; k < sizeof(V) / sizeof(x[0]); ++k) root[k] = std::sqrt(x[k]);
}

#else

using Floats4 = float __attribute__((vector_size(16)));
using Floats8 = float __attribute__((vector_size(32)));
using Floats16 = float __attribute__((vector_size(64)));
using Doubles2 = double __attribute__((vector_size(16)));
using Doubles4 = double __attribute__((vector_size(32)));
using Ints4 = int __attribute__((vector_size(16)));

// All are inlined: source files for several instruction sets include this (make_film_kernels.h).
template <class V>
SUNBEAM_ALWAYS_INLINE V select(const decltype(V{} < V{}) & mask, const V& a, const V& b) {
  return mask ? a : b;
}
template <class To, class From>
SUNBEAM_ALWAYS_INLINE To convert(const From& from) {
  return __builtin_convertvector(from, To);
}
template <class To, class From>
SUNBEAM_ALWAYS_INLINE To bits_as(const From& from) {
  return (To)from;
}
template <int... kLane, class V>
SUNBEAM_ALWAYS_INLINE auto shuffle(const V& a, const V& b) {
  return __builtin_shufflevector(a, b, kLane...);
}
SUNBEAM_ALWAYS_INLINE void square_root(const Floats4& x, Floats4& root) {
  root = Floats4{__builtin_sqrtf(x[0]), __builtin_sqrtf(x[1]), __builtin_sqrtf(x[2]), __builtin_sqrtf(x[3])};
}
SUNBEAM_ALWAYS_INLINE void square_root(const Doubles4& x, Doubles4& root) {
  root = Doubles4{__builtin_sqrt(x[0]), __builtin_sqrt(x[1]), __builtin_sqrt(x[2]), __builtin_sqrt(x[3])};
}

#endif

}  // namespace v1
}  // namespace sunbeam
