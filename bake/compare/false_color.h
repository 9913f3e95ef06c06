// This file shows numbers as colours.
#pragma once

#include <string>
#include <vector>

namespace sunbeam {

// Returns a PNG file of width x height values, rows from the top, in the colours of the map magma (S. van der
// Walt and N. Smith, matplotlib 1.5): 0 black, through purple and orange, 1 pale yellow; lightness grows
// evenly. Values outside [0, 1] take the colour of the nearest end. Throws Error if the picture cannot be
// encoded.
std::string magma_png(const std::vector<double>& values, int width, int height);

}  // namespace sunbeam
