// This file holds heights on the unit square that repeat in both directions: what a relief is made of.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sunbeam/detail/warp.h"

namespace sunbeam {

// Pixels are samples at pixel centres, rows from the top: v = 0 is the lower edge of the last row, u = 0 the
// left edge of the first column. The surface between them is a periodic uniform bicubic B-spline with the
// pixels as its control points: its normals have no creases, and detail of about a pixel is smoothed.
struct HeightMap {
  int width = 0, height = 0;
  std::vector<float> values;

  struct Sample {
    double height = 0;
    Point2 gradient;  // d height / d(u, v), exact
  };
  // Evaluates the surface at any (u, v); whole numbers are dropped from both. The map must not be empty.
  Sample sample(const Point2& uv) const;

  float at(int column, int row) const {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
};

// Reads heights. Of an .exr it takes channel Y, else R, of any pixel type; of a .png grey, 0 to 1, 16 bits as
// they stand, 8 bits without undoing sRGB, for heights are no colours. Throws Error naming the file if it
// cannot be read or holds a value that is not finite or beyond +-1e6.
HeightMap load_height_map(const std::string& path);

// Writes heights: an .exr has one 32-bit float channel Y, a .png 16-bit grey, values clamped to [0, 1]. Both
// throw Error for another extension.
void require_height_map_extension(const std::string& path);
void write_height_map(const std::string& path, const HeightMap& map);

}  // namespace sunbeam
