// What a textured table knows of one parameter point; the library's own business.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "sunbeam/material.h"

namespace sunbeam {

// What of the frame of L in textured_table.h one table has for all points.
struct TexturedMaterial {
  explicit TexturedMaterial(const Material& material);

  float film_scale, film_offset;  // of c~^2
  float least_below;              // of m~^2
  bool bends;
  double exterior_ior, pigment_thickness_nm;
};

// The frame of L at one base and optical depth. Cosines are squared here.
struct TexturedFrame {
  TexturedFrame(const TexturedMaterial& material, double base_ior, double optical_depth);

  // c~^2.
  float film_cosine_squared(float c) const { return film_scale * c * c + film_offset; }
  // m~^2.
  float pigment_cosine_squared(float c) const {
    return std::max(below_scale * c * c + below_offset, 0.0f) + least_below;
  }

  float film_scale, film_offset;
  float below_scale, below_offset, least_below;  // the first two give the cosine below the film
  float optical_depth;
};

// Parameters among the nodes of L.
struct TexturedPlace {
  std::size_t row;              // the lowest of eight neighbours; cosines follow each other
  std::size_t nearest;          // of them
  std::array<float, 8> weight;  // of the neighbours: thickness is the highest bit, absorption the lowest
};

}  // namespace sunbeam
