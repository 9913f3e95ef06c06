// The part of a table that one parameter point is interpolated from.
#pragma once

#include "sunbeam/table_io.h"

namespace sunbeam {

// Of a dense table whose values are not in memory: bound at `parameters` (clamped to the grid) it gives the
// same bits as the whole.
Table table_around(const Table& outline, const DenseCells& cells, const Parameters& parameters);

}  // namespace sunbeam
