// This picture shows a sphere of a material, seen in parallel projection, under one directional light and a
// grey sky that is bright at the horizon. Directions are fixed and nothing is random, so that a table and the
// live model are comparable pixel by pixel.
#pragma once

#include "bake/report/appearance.h"
#include "runtime/tracer/image.h"

namespace sunbeam {

Image sphere_image(const Appearance& skin, int pixels, int threads = 0);

}  // namespace sunbeam
