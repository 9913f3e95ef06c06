// This file says how look-ups are prepared from a table (table_bsdf.h, textured_table.h).
#pragma once

#include <optional>

#include "sunbeam/core/color_space.h"
#include "sunbeam/detail/processor.h"

namespace sunbeam {
inline namespace v1 {

// Says what becomes of parameters beyond those of the table.
enum class OutsideGrid { clamp, refuse };

struct BindOptions {
  OutsideGrid outside = OutsideGrid::refuse;

  // Values and throughputs come out in this space; without one, in Table::color_space(). Colours that the
  // space cannot show have negative components, and so may an estimate that stands for them.
  std::optional<ColorSpace> color_space = std::nullopt;

  // Raises negative components of eval() and of throughputs to 0, for hosts that cannot take them. That adds
  // light (core/color_space.h), and reciprocity stays.
  bool clip_negative = false;

  Arithmetic arithmetic = Arithmetic::fastest;
};

}  // namespace v1
}  // namespace sunbeam
