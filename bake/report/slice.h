// What has been below the film, as a picture: pi * rest, theta_o in the plane of incidence from -90 degrees
// (the side of the light) to 90 (the mirror side) to the right, theta_i from 0 to 90 degrees upwards.
#pragma once

#include "bake/report/appearance.h"
#include "runtime/tracer/image.h"

namespace sunbeam {

// Twice as wide as high.
Image slice_image(const Appearance& skin, int height, int threads = 0);

// Largest component.
double brightest(const Image& image);
Image scaled(Image image, double factor);

}  // namespace sunbeam
