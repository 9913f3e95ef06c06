// This file sums series of visits: light that comes once and then again and again.
#pragma once

#include "bake/live/exact/dense.h"

namespace sunbeam {

// Returns (1 - a)^-1 first = first + a first + a a first + ...: `first` is what the first visit gives, by
// columns, and `a` what one more visit makes of it.
inline Matrix resolvent(Matrix a, Matrix first) { return solve(one_minus(std::move(a)), std::move(first)); }

}  // namespace sunbeam
