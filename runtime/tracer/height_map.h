// This file holds heights on the unit square that repeat in both directions: what a relief is made of.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
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

// Reads heights: of an EXR channel Y, else R, of any pixel type, in the display window, 0 where the data
// window has no pixel; of a PNG its grey numbers over 255 or 65535 as they are stored, whatever gAMA, sRGB or
// iCCP say, for heights are no colours. Throws Error naming the file if it cannot be read, asks for too much
// memory, holds a value that is not finite or beyond +-1e6, or is a PNG of colours.
HeightMap load_height_map(const std::string& path);
// Reads the same from the bytes of a file.
HeightMap parse_height_map(std::string_view bytes, const std::string& name);

// Writes heights: an .exr has one 32-bit float channel Y, a .png 16-bit grey, values clamped to [0, 1]. Both
// throw Error for another extension.
void require_height_map_extension(const std::string& path);
void write_height_map(const std::string& path, const HeightMap& map);

}  // namespace sunbeam
