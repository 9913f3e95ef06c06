// This file makes daylight: a clear sky as an environment map, and the sun that belongs to it. It follows A.
// J. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999: luminance and
// chromaticity of the sky by Perez's formula (section 3.1 and appendix A.2), sunlight through the atmosphere
// (appendix A.1).
//
// Colours are linear Rec.709 whose luminance (Y) is the photometric one, in units of 1000 cd/m^2 for radiance
// and 1000 lux for irradiance, times `scale`. A clear sky has 2 to 30, the sun at noon 10^6 and 10^2.
#pragma once

#include "runtime/tracer/image.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {

struct Sky {
  Vec3 sun_direction{0, 0, 1};  // towards the sun, of any length; z >= 0: not below the horizon
  double turbidity = 3;         // [2, 10]: 3 clear, 6 and above hazy; at 2 the horizon outshines all else
  Rgb ground_albedo;            // [0, 1]; of the diffuse ground that fills the lower half; 0: it is black
  double scale = 1;             // > 0
};

// Describes the sun's disc, of one radiance all over.
struct SunLight {
  Vec3 direction;         // unit, towards its centre
  double angular_radius;  // radians; the disc is 0.53 degrees across
  Rgb radiance;           // of the disc
  Rgb irradiance;         // of a surface that faces it: radiance times the solid angle of the disc
};

// All throw Error for what Sky does not allow. Negative components, of chromaticities outside Rec.709, are
// raised to 0.

// Returns the radiance of the sky, without the sun's disc, from the unit direction `w`, w.z >= 0.
Rgb sky_radiance(const Sky& sky, const Vec3& w);

// Returns a map as EnvironmentSource::map has it. Each texel is the radiance at its centre, without the sun's
// disc; below the horizon it is the ground under sky and sun. width, height >= 1.
Image sky_map(const Sky& sky, int width, int height);

SunLight sun_light(const Sky& sky);

}  // namespace sunbeam
