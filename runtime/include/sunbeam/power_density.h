// A density over the hemisphere between two powers of the cosine, drawn without the library's pow: exponents
// are 2^j - 1, whose inverse is j roots.
#pragma once

#include <cmath>

#include "sunbeam/core/rng.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {

class PowerDensity {
 public:
  // Near cos^exponent, exponent >= 1 (more than 15 counts as 15).
  explicit PowerDensity(float exponent) {
    const float next = exponent + 1;
    level_ = 1 + static_cast<int>(next >= 4) + static_cast<int>(next >= 8);
    const auto lower = static_cast<float>(1 << level_);
    upper_ = std::min(std::max(next / lower - 1, 0.0f), 1.0f);
  }

  // Cosine, > 0.
  float sample(Rng& rng) const {
    const int more = rng.uniform() < double{upper_} ? 1 : 0;
    float roots[kLevels + 1];  // all of them, for a processor would guess wrong how many
    float x = 1 - static_cast<float>(rng.next() >> 8) * 0x1p-24f;  // > 0
    for (float& root : roots) root = x = std::sqrt(x);
    return roots[level_ - 1 + more];
  }
  // 1/sr, uniform in azimuth.
  float pdf(float cosine) const {
    const float c2 = cosine * cosine, c4 = c2 * c2;
    const float to_level[kLevels] = {1, c2, c4 * c2};  // cos^(2^j - 2)
    const float to_next[kLevels] = {c2, c4, c4 * c4};  // cos^(2^j)
    const auto lower = static_cast<float>(1 << level_);
    constexpr auto kPerTurn = static_cast<float>(kInvPi / 2);
    return kPerTurn * lower * cosine * to_level[level_ - 1] * (1 - upper_ + upper_ * 2 * to_next[level_ - 1]);
  }

 private:
  static constexpr int kLevels = 3;

  int level_ = 1;    // to kLevels
  float upper_ = 0;  // chance of the next level
};

}  // namespace sunbeam
