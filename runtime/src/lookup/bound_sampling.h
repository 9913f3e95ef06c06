// This file makes what BoundTable (runtime/src/lookup/bound_table.h) samples with, from the values of a table
// at one parameter point. Densities follow the mean over channels, and over the viewer's azimuth.
#pragma once

#include "runtime/src/lookup/bound_values.h"
#include "runtime/src/sampling/cosine_rows.h"
#include "runtime/src/sampling/facet_cells.h"

namespace sunbeam {
inline namespace v1 {

struct BoundSampling {
  explicit BoundSampling(const BoundValues& values);

  // Viewers are at even roots of the cosine, as many as rows.
  static constexpr int kViewers = FacetCells::kRows;

  std::vector<float> first_chances;  // of sampling the first surface, for each viewer
  CosineRows rest;
  std::vector<float> rest_densities;  // over the root of the light's cosine: (viewer, node of CosineRows)
  FacetCells first;                   // empty but for an isotropic rough film
};

}  // namespace v1
}  // namespace sunbeam
