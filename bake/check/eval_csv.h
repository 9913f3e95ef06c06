// Evaluates a live recipe or a table at the rows of a CSV file.
//
// Columns: any material key overrides the recipe (a table: only its three parameters; an albedo is linear
// Rec.709, as in a recipe), wavelength_nm makes the row monochromatic (a table: one of the three of rgb3;
// refused in mode full, which holds folded colours), theta_i_deg, theta_o_deg in [0, 90), phi_deg = azimuth
// from wi to wo (mirror: 180), phi_i_deg (0 if absent) = azimuth of wi from the tangent. Other columns are
// carried through. Results are appended as columns, suffixed _r _g _b (in the colour space of the recipe or
// table) unless monochromatic:
//   brdf    first, rest, stderr (of rest), pdf (one number), dirac
//   albedo  total (Dirac included), stderr
//   film    reflectance (at theta_i_deg, from outside)
#pragma once

#include <cstdint>
#include <iosfwd>
#include <set>
#include <string>

#include "bake/live/estimator.h"
#include "bake/optics/spectrum.h"
#include "sunbeam/material.h"
#include "sunbeam/table.h"

namespace sunbeam {

enum class Quantity { brdf, albedo, film };

struct PointsSettings {
  Quantity quantity = Quantity::brdf;
  std::int64_t samples = 10000;  // estimates a row (live only), at least 2
  std::uint64_t seed = 1;        // row k uses random stream k
  // Only live evaluation uses it, row by row if it is automatic. With exact, rest and albedo come by
  // quadrature and stderr is 0.
  Estimator estimator = Estimator::pfmc;
};

// Both evaluate the rows of `csv`, whose name in messages is `name`, and write them with the results. Throws
// Error before anything is written if a row is bad. The live one returns the names of the estimators used.
std::set<std::string> evaluate_points_live(const Material& material, const Spectrum& spectrum,
                                           std::istream& csv, const std::string& name,
                                           const PointsSettings& settings, std::ostream& out);
void evaluate_points_table(const Table& table, std::istream& csv, const std::string& name,
                           const PointsSettings& settings, std::ostream& out);

}  // namespace sunbeam
