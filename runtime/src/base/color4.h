// This file holds colours as look-ups carry them: four floats in a register, the last without meaning.
#pragma once

#include <limits>

#include "runtime/src/base/lanes.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

using Color4 = Floats4;

inline Color4 to_color4(const Rgb& c) {
  return Color4{static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b), 0};
}
inline Rgb to_rgb(const Color4& c) { return {c[0], c[1], c[2]}; }

// Where one instruction does it, it is named: compilers do not see it in what is written for the others.
#if defined(__SSE2__) && !defined(SUNBEAM_PORTABLE)

inline Color4 to_floats(const Doubles2& low, const Doubles2& high) {
  return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
}
inline Color4 sqrt4(const Color4& x) { return _mm_sqrt_ps(x); }
// Returns a bit for each lane of a comparison, 1 where it holds.
inline int mask_of(const Ints4& holds) { return _mm_movemask_ps(bits_as<__m128>(holds)); }
inline Color4 min4(const Color4& a, const Color4& b) { return _mm_min_ps(a, b); }
inline Color4 max4(const Color4& a, const Color4& b) { return _mm_max_ps(a, b); }

#else

inline Color4 to_floats(const Doubles2& low, const Doubles2& high) {
  return Color4{static_cast<float>(low[0]), static_cast<float>(low[1]), static_cast<float>(high[0]),
                static_cast<float>(high[1])};
}
inline Color4 sqrt4(const Color4& x) {
  Color4 root;
  square_root(x, root);
  return root;
}
inline int mask_of(const Ints4& holds) { return -(holds[0] + 2 * holds[1] + 4 * holds[2] + 8 * holds[3]); }
// These return the lesser and the greater of two numbers, four times; `b` where `a` is not a number.
inline Color4 min4(const Color4& a, const Color4& b) { return select(a < b, a, b); }
inline Color4 max4(const Color4& a, const Color4& b) { return select(a > b, a, b); }

#endif

// Returns what components are raised to: 0 if negative ones are clipped, else a number below all.
inline Color4 least_component(bool clip_negative) {
  const float least = clip_negative ? 0 : std::numeric_limits<float>::lowest();
  return Color4{least, least, least, least};
}

// Finds four EvenPosition at once, from coordinates >= 0 that count nodes. None goes beyond its `last`, whose
// place is the last node with a weight of 0 for one more, which must exist.
struct EvenPositions {
  EvenPositions(const Color4& coordinates, const Color4& last) {
    const Color4 inside = min4(coordinates, last);
    lower = convert<Ints4>(inside);
    upper_weight = inside - convert<Color4>(lower);
  }
  Ints4 lower;
  Color4 upper_weight;
};

// Says where x in [0, 1] lies among nodes spread evenly over it.
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

}  // namespace v1
}  // namespace sunbeam
