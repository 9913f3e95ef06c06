// This file draws the figures of a verification against each parameter and theta_i.
#pragma once

#include <string>
#include <vector>

#include "bake/check/verify.h"

namespace sunbeam {

// Describes the axis that points are laid out over.
struct ErrorAxis {
  std::string name, unit;
  double low, high;
  std::vector<double> nodes;   // of the table; none: not shown
  std::vector<double> values;  // one for each point
};

// Returns the parameters that the table sweeps, and theta_i.
std::vector<ErrorAxis> error_axes(const Table& table, const VerifyReport& report);

inline constexpr double kErrorChartWidth = 500, kErrorChartHeight = 362;

// Returns an SVG fragment. Above it shows the error with its median and 99th percentile, below, on the same
// scale, the noise of the comparison: what of the error could be walks and not the table.
std::string error_chart(const ErrorAxis& axis, const VerifyReport& report, double tolerance_p99);

inline constexpr double kAlbedoChartWidth = 500, kAlbedoChartHeight = 230;
std::string albedo_chart(const VerifyReport& report);

}  // namespace sunbeam
