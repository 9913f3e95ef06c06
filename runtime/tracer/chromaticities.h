// This file converts pictures whose file states other primaries than those of Rec.709.
#pragma once

#include "runtime/tracer/image.h"
#include "sunbeam/core/color_space.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

// The CIE 1931 (x, y) of an RGB space. A primary may be imaginary, and even have y = 0.
struct Chromaticities {
  Point2 red, green, blue, white;
};

// Returns whether these are Rec.709 with D65 up to the rounding of files.
bool is_rec709(const Chromaticities& space);

// Maps linear RGB of this space to linear Rec.709, adapted from white to white after Bradford: (1, 1, 1)
// stays (1, 1, 1). Throws Error if the primaries lie on a line, the white outside of them, or a number is not
// finite.
ColorMatrix to_rec709(const Chromaticities& space);

// Converts every pixel, unless the space is Rec.709. What a float cannot hold becomes infinite.
void convert_to_rec709(Image& image, const Chromaticities& space);

}  // namespace sunbeam
