// This file checks what a table must hold to be looked up: arrays, their axes and their ranges. Every
// function throws Error that names the attribute, array or axis; from_parts() of table_parts.h adds the file.
#pragma once

#include <span>
#include <string>

#include "runtime/src/table/table_parts.h"

namespace sunbeam {
inline namespace v1 {

std::string name_of(Symmetry symmetry);

void require_finite(const ArrayView& array);

// Returns the array of that name, if its axes have those names, it has as many channels and its values are
// finite.
NdArray checked_array(TableParts& parts, const std::string& name, std::span<const char* const> axis_names,
                      std::size_t channels = 3);

// Checks that the symmetry is the roughness's.
void check_symmetry(const Table& table);
// Checks the ranges of the parameters and of a dense table's axes.
void check_ranges(const Table& table);
// Checks the axes of an array of factors; those from `first_cosine` on are pairs of a cosine and an azimuth.
void check_factor_axes(const Table& table, const NdArray& array, std::size_t first_cosine);
// Check the axes of arrays of a layered film; look-ups locate facets on the same nodes in both.
void check_crossing_axes(const Table& table, const NdArray& facet_cosine, const NdArray& crossing);
void check_returning_axes(const Table& table, const NdArray& return_cosine, const NdArray& returning);
// Checks the range of the optical path.
void check_first_visit_axis(const NdArray& first_visit);
// Checks that look-ups may locate wi and wo, whose axes begin at `first_cosine`, on the same nodes.
void check_same_ends(const NdArray& exchange, std::size_t first_cosine);

}  // namespace v1
}  // namespace sunbeam
