// This file holds what a textured table knows of one parameter point (textured_table.h). It is the library's
// own business.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// Returns the path of light between reflections in a rough film, over that at normal incidence; it is 1 for a
// smooth one, whose fringes are not in L.
double textured_path(const Material& material, double cosine);

// Evaluates the closed forms of the film that one table has for all points: c~, the path in the film, and
// what m~ needs of the material. Cosines are squared here.
struct FilmCosines {
  // `is_warped` is that of the table's FactorFrame (factor_frame.h).
  FilmCosines(const Material& material, bool is_warped);

  // Returns c~^2.
  float film_cosine_squared(float c) const { return film_scale * c * c + film_offset; }
  // Returns the square of textured_path(), as fringe_order() in factors.h has it.
  float path_squared(float c) const { return std::max(path_scale * c * c + path_offset, least_path); }

  // Returns how the transmittance falls towards grazing, after Schlick. It is enough to take the pole from L.
  static float passing(float film_cosine) {
    const float x = 1 - film_cosine, x2 = x * x;
    return 1 - x2 * x2 * x;
  }

  float film_scale, film_offset;
  float path_scale, path_offset, least_path;
  float least_below;  // of m~^2
  float visit_blur2;  // of the square of the cosine of one visit
  float softness;     // of the warped cosine
  bool bends, is_warped;
  double exterior_ior, pigment_thickness_nm;
};

// Evaluates the closed forms of the pigment at one base IOR and optical depth: m~ and m.
struct PigmentCosines {
  PigmentCosines(const FilmCosines& material, double base_ior, double optical_depth);

  // Returns m~^2.
  float pigment_cosine_squared(float c) const {
    return std::max(below_scale * c * c + below_offset, 0.0f) + least_below;
  }

  // Returns the cosine of one visit of the base, kept above 0.
  float cosine_below(float c) const {
    return std::sqrt(std::max(std::max(below_scale * c * c + below_offset, 0.0f) + visit_blur2, 1e-12f));
  }

  // Returns the warped cosine; `root` is that of warp_radicand().
  float warp_radicand(float c) const { return std::abs(c - critical) + softness; }
  float warped(float c, float root) const {
    return std::max((c - critical) / root * per_extent - first_warped, 0.0f);
  }

  void take_warp(const FilmCosines& material, double base_ior);

  float below_scale, below_offset, least_below;  // the first two give the cosine below the film
  float visit_blur2, optical_depth;
  float critical = 0, softness = 1, per_extent = 0, first_warped = 0;  // of the warped cosine
};

// Says where the base IOR and the absorption lie among the nodes of L, and holds the thickness.
struct ParameterTaps {
  float thickness_nm;
  std::size_t row;              // the lowest of four neighbours, at the first path and cosine
  std::size_t nearest;          // of them
  std::array<float, 4> weight;  // of the neighbours: base IOR is the higher bit, absorption the lower
};

}  // namespace v1
}  // namespace sunbeam
