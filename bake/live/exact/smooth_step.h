// This file holds the variable t in [0, 1] of a panel of quadrature: its flat ends turn square-root
// singularities there into smooth functions.
#pragma once

#include <cmath>

namespace sunbeam {

inline double smooth_step(double t) { return t * t * (3 - 2 * t); }
inline double smooth_step_slope(double t) { return 6 * t * (1 - t); }
inline double inverse_smooth_step(double x) { return 0.5 - std::sin(std::asin(1 - 2 * x) / 3); }

}  // namespace sunbeam
