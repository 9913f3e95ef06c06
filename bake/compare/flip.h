// This file computes LDR-FLIP, which says how different two pictures look when one flips between them:
// Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images", PACM CGIT 3(2), 2020.
#pragma once

#include <vector>

#include "runtime/tracer/image.h"

namespace sunbeam {

// This belongs to a display 0.7 m away that is 0.7 m and 3840 pixels wide.
inline constexpr double kDefaultPixelsPerDegree = 67;
// Filters are as wide as a seventh of a degree: more would only blur a picture into its borders.
inline constexpr double kMostPixelsPerDegree = 1000;

// Returns FLIP of every pixel, rows from the top: 0 where nothing differs, 1 at most (but for rounding). Both
// pictures hold display-linear Rec.709, [0, 1], of one size; pixels_per_degree lies in (0,
// kMostPixelsPerDegree]. Beyond the borders the outermost pixels go on. The order of the pictures does not
// matter.
std::vector<double> flip(const Image& test, const Image& reference, double pixels_per_degree);

// Returns the image as a PNG of it shows it: negative components are raised to 0, then display_color() is
// applied.
Image displayed(const Image& image);

}  // namespace sunbeam
