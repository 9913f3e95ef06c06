// This file computes with azimuths in single floats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

// Computes cosine and sine to 2e-7: those of a table, turned on by at most half a step, where short series
// do. Nothing waits long for anything else, and there is no choice that a processor would have to guess.
struct FloatTurn {
  static constexpr int kSteps = 32;

  // Takes the angle 2 pi (step + inside) / kSteps, inside in [0, 1].
  FloatTurn(std::uint32_t step, float inside) {
    const float x = static_cast<float>(2 * kPi / kSteps) * (inside - 0.5f), x2 = x * x;
    const float s = x * (1 - x2 * (1.0f / 6 - x2 * (1.0f / 120))),
                c = 1 - x2 * (0.5f - x2 * (1.0f / 24 - x2 * (1.0f / 720)));
    const auto [middle_c, middle_s] = kMiddles[step];
    cosine = middle_c * c - middle_s * s;
    sine = middle_s * c + middle_c * s;
  }
  // Takes a turn's part u in [0, 1).
  explicit FloatTurn(double u) : FloatTurn(Step(u)) {}

  float cosine, sine;

 private:
  struct Step {
    explicit Step(double u)
        : step(static_cast<std::uint32_t>(u * kSteps)), inside(static_cast<float>(u * kSteps - step)) {}
    std::uint32_t step;
    float inside;
  };
  explicit FloatTurn(const Step& at) : FloatTurn(at.step, at.inside) {}

  struct Middle {
    float cosine, sine;
  };
  static const std::array<Middle, kSteps> kMiddles;  // of steps
};

inline const std::array<FloatTurn::Middle, FloatTurn::kSteps> FloatTurn::kMiddles = [] {
  std::array<Middle, kSteps> middles;
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double angle = 2 * kPi * (static_cast<double>(k) + 0.5) / kSteps;
    middles[k] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
  }
  return middles;
}();

}  // namespace v1
}  // namespace sunbeam
