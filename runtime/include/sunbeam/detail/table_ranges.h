// This file says what values the arrays of a table may hold, so that every look-up is finite. The ranges are
// stated in docs/reference/table_format.md.
#pragma once

#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

// The largest optical depth of path "product" in a factored table, which multiplies by up to its exponential.
inline constexpr double kDeepestProduct = 40;

// Throws Error naming the array, the value and the range if an array of `table` leaves its range, or if the
// optical depths of path "product" or a layered film do. What bakes write passes with room.
void require_in_ranges(const Table& table);

}  // namespace v1
}  // namespace sunbeam
