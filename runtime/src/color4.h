// Colours as look-ups carry them: four floats in a register, the last without meaning.
#pragma once

#include "sunbeam/core/vec.h"

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace sunbeam {

using Color4 = float __attribute__((vector_size(16)));

inline Color4 to_color4(const Rgb& c) {
  return Color4{static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b), 0};
}
// Of four numbers at once.
inline Color4 sqrt4(const Color4& x) {
#ifdef __SSE__
  return _mm_sqrt_ps(x);
#else
  return Color4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}

inline Rgb to_rgb(const Color4& c) { return {c[0], c[1], c[2]}; }

// Where x in [0, 1] lies among nodes spread evenly over it.
struct EvenPosition {
  EvenPosition(float x, int nodes) {
    const float position = x * static_cast<float>(nodes - 1);
    lower = static_cast<int>(position);
    lower = lower < nodes - 2 ? lower : nodes - 2;
    upper_weight = position - static_cast<float>(lower);
  }
  int lower;
  float upper_weight;
};

inline Color4 lerp(const Color4* nodes, const EvenPosition& at) {
  return nodes[at.lower] + at.upper_weight * (nodes[at.lower + 1] - nodes[at.lower]);
}

}  // namespace sunbeam
