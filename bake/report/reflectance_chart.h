// This chart shows the film's reflectance: its colour over thickness and angle, and R, G, B over the angle at
// one thickness.
#pragma once

#include <string>

#include "sunbeam/table.h"

namespace sunbeam {

inline constexpr double kReflectanceWidth = 560, kReflectanceHeight = 520;

// Returns an SVG fragment of that size. Throws Error if the parameters lie outside the table.
std::string reflectance_chart(const Table& table, const Parameters& parameters);

}  // namespace sunbeam
