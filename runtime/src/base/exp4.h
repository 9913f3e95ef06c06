// This file computes exp of four floats at once.
#pragma once

#include "runtime/src/base/color4.h"

namespace sunbeam {
inline namespace v1 {

// Returns exp with a relative error of 3e-7. Arguments are kept within [-87, 87], so the result is a normal
// number.
inline Color4 exp4(const Color4& x) {
  constexpr float kMost = 87, kPerLog2 = 1.44269504f;
  constexpr float kLog2High = 0.693145752f, kLog2Low = 1.42860677e-6f;  // their sum is log 2
  constexpr float kRound = 0x1.8p23f;  // adding and subtracting it rounds to the nearest integer
  Color4 y = select(x < kMost, x, Color4{} + kMost);
  y = select(y > -kMost, y, Color4{} - kMost);
  const Color4 power = (y * kPerLog2 + kRound) - kRound;
  const Color4 f = (y - power * kLog2High) - power * kLog2Low;  // |f| <= log(2) / 2
  const Color4 series =
      1 + f * (1 + f * (0.5f + f * (0.166666667f +
                                    f * (0.0416666667f + f * (0.00833333333f + f * 0.00138888889f)))));
  return bits_as<Color4>(bits_as<Ints4>(series) + (convert<Ints4>(power) << 23));
}

}  // namespace v1
}  // namespace sunbeam
