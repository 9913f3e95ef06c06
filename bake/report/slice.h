// This picture shows what has been below the film: pi * rest, with theta_o in the plane of incidence from -90
// degrees (the side of the light) to 90 (the mirror side) to the right, theta_i from 0 to 90 degrees upwards.
#pragma once

#include "bake/report/appearance.h"
#include "runtime/tracer/image.h"

namespace sunbeam {

// Returns a picture twice as wide as high.
Image slice_image(const Appearance& skin, int height, int threads = 0);

// Returns the largest component.
double brightest(const Image& image);
Image scaled(Image image, double factor);

}  // namespace sunbeam
