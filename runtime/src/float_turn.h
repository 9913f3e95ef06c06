// A random azimuth in single floats.
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {

// Cosine and sine of 2 pi u, u in [0, 1], to 5e-7 in single floats, without a choice that a processor would
// have to guess: by Taylor series of the half angle, turned by a quarter. Pairs of terms do not wait for
// others.
struct FloatTurn {
  explicit FloatTurn(float u) {
    const float x = static_cast<float>(kPi) * (u - 0.5f), x2 = x * x, x4 = x2 * x2;
    const float s = x * ((1 - x2 * (1.0f / 6)) + x4 * ((1.0f / 120 - x2 * (1.0f / 5040)) +
                                                       x4 * (1.0f / 362880 - x2 * (1.0f / 39916800))));
    const float c =
        1 - x2 * (0.5f - x2 * (1.0f / 24)) +
        x4 * x2 * ((x2 * (1.0f / 40320) - 1.0f / 720) + x4 * (x2 * (1.0f / 479001600) - 1.0f / 3628800));
    cosine = s * s - c * c;
    sine = -2 * s * c;
  }
  float cosine, sine;
};

}  // namespace sunbeam
