// This chart shows BRDF times cosine over theta_o in the plane of incidence, for R, G and B. The table's thin
// lines lie over the thick pale ones of the live model. The radius is the square root of the value, so that a
// narrow highlight does not hide the rest.
#pragma once

#include <string>

#include "bake/report/appearance.h"

namespace sunbeam {

inline constexpr double kPolarWidth = 340, kPolarHeight = 232;

// Returns an SVG fragment of that size. A smooth film's Dirac appears as a dashed line in the mirror
// direction.
std::string polar_chart(const Appearance& table, const Appearance& live, const Vec3& wi);

}  // namespace sunbeam
