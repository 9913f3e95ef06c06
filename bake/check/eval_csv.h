// Evaluates a live recipe or a table at the rows of a CSV file.
//
// Columns: any material key overrides the recipe (a table: only its three parameters; an albedo is linear
// Rec.709, as in a recipe), wavelength_nm makes the row monochromatic (a table: one of the three of rgb3;
// refused in mode full, which holds folded colours), theta_i_deg, theta_o_deg in [0, 90), phi_deg = azimuth
// from wi to wo (mirror: 180), phi_i_deg (0 if absent) = azimuth of wi from the tangent. Columns that are
// unlike all of these are carried through. Results are appended as columns, suffixed _r _g _b (in the colour
// space of the recipe or table) unless monochromatic:
//   brdf    first, rest, stderr (of rest), pdf (one number), dirac
//   albedo  total (Dirac included), stderr
//   film    reflectance (at theta_i_deg, from outside)
#pragma once

#include <cstdint>
#include <iosfwd>
#include <set>
#include <string>
#include <vector>

#include "bake/check/point_columns.h"
#include "bake/live/estimator.h"
#include "bake/optics/spectrum.h"
#include "sunbeam/material.h"
#include "sunbeam/table.h"

namespace sunbeam {

struct PointsSettings {
  Quantity quantity = Quantity::brdf;
  std::int64_t samples = 10000;  // estimates a row (live only), at least 2
  std::uint64_t seed = 1;        // row k uses random stream k
  // Only live evaluation uses it, row by row if it is automatic. With exact, rest and albedo come by
  // quadrature and stderr is 0.
  Estimator estimator = Estimator::pfmc;
};

struct PointsReport {
  std::set<std::string> estimators;         // that were used; none for a table
  std::vector<std::string> unused_columns;  // that were carried through
};

// Both evaluate the rows of `csv` and write them with the results. They throw Error before anything is
// written if a row is bad.
PointsReport evaluate_points_live(const Material& material, const Spectrum& spectrum, const Csv& csv,
                                  const PointsSettings& settings, std::ostream& out);
PointsReport evaluate_points_table(const Table& table, const Csv& csv, const PointsSettings& settings,
                                   std::ostream& out);

}  // namespace sunbeam
