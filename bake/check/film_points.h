// This file evaluates stacks of layers at the rows of a CSV file: --quantity film with a column `layers`.
#pragma once

#include <iosfwd>

#include "bake/check/point_columns.h"
#include "bake/optics/dispersion/film_design.h"
#include "sunbeam/material.h"

namespace sunbeam {

// Says whether the CSV is one of stacks. Throws Error if it has columns of stacks and cannot be one.
bool holds_film_points(const Csv& csv, Quantity quantity);

// Columns: `layers`, thickness_nm/ior/extinction of every layer from top to bottom, separated by ';';
// theta_i_deg, wavelength_nm; exterior_ior, base_ior and base_extinction, those of the recipe if absent,
// whose `material` and `film` are given. A base of its own index takes both columns of the base or none.
// Writes the rows with the powers reflectance, transmittance and reflectance_below: the last along the
// direction that light takes in the base, empty if the base absorbs or there is none. Throws Error before
// anything is written if a row is bad.
void evaluate_film_points(const Material& material, const FilmDesign& film, const Csv& csv,
                          std::ostream& out);

}  // namespace sunbeam
