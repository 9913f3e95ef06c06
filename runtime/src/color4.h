// Colours as look-ups carry them: four floats in a register, the last without meaning.
#pragma once

#include "sunbeam/core/vec.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace sunbeam {

using Color4 = float __attribute__((vector_size(16)));

inline Color4 to_color4(const Rgb& c) {
  return Color4{static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b), 0};
}
using Doubles2 = double __attribute__((vector_size(16)));
inline Color4 to_floats(const Doubles2& low, const Doubles2& high) {
#ifdef __SSE2__
  return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
#else
  return Color4{static_cast<float>(low[0]), static_cast<float>(low[1]), static_cast<float>(high[0]),
                static_cast<float>(high[1])};
#endif
}

// Of four numbers at once.
inline Color4 sqrt4(const Color4& x) {
#ifdef __SSE2__
  return _mm_sqrt_ps(x);
#else
  return Color4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}

// The lesser and the greater of two numbers, four times; `b` where `a` is not a number.
inline Color4 min4(const Color4& a, const Color4& b) {
#ifdef __SSE2__
  return _mm_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}

inline Color4 max4(const Color4& a, const Color4& b) {
#ifdef __SSE2__
  return _mm_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}

inline Rgb to_rgb(const Color4& c) { return {c[0], c[1], c[2]}; }

using Ints4 = int __attribute__((vector_size(16)));

// Four of them, from coordinates >= 0 that count nodes; none goes beyond its `last`, whose place is the last
// node with a weight of 0 for one more, which must exist.
struct EvenPositions {
  EvenPositions(const Color4& coordinates, const Color4& last) {
    const Color4 inside = min4(coordinates, last);
    lower = __builtin_convertvector(inside, Ints4);
    upper_weight = inside - __builtin_convertvector(lower, Color4);
  }
  Ints4 lower;
  Color4 upper_weight;
};

// Where x in [0, 1] lies among nodes spread evenly over it.
struct EvenPosition {
  EvenPosition(float x, int nodes) {
    const float position = x * static_cast<float>(nodes - 1);
    lower = static_cast<int>(position);
    lower = lower < nodes - 2 ? lower : nodes - 2;
    upper_weight = position - static_cast<float>(lower);
  }
  EvenPosition(const EvenPositions& four, int k) : lower(four.lower[k]), upper_weight(four.upper_weight[k]) {}
  int lower;
  float upper_weight;
};

template <class T>
T lerp(const T* nodes, const EvenPosition& at) {
  return nodes[at.lower] + at.upper_weight * (nodes[at.lower + 1] - nodes[at.lower]);
}

}  // namespace sunbeam
