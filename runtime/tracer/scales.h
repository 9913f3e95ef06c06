// This file makes scales as a height map that repeats without a seam: cells of a regular hexagonal grid,
// Voronoi cells of a blue-noise point set, or the scales of a snake.
//
// Lengths here are in scale widths: the distance of neighbouring centres of the hexagonal grid. A tile is
// `columns` wide and `rows` * sqrt(3)/2 high; a grid or blue noise has columns * rows cells in it.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/tracer/height_map.h"

namespace sunbeam {

// Names a pattern. In `grid` all cells are alike, as `jitter` says. Those of a snake (snake_scales.h) take
// the tile for the whole girth.
enum class ScalePattern { grid, snake_body, snake_head };

struct ScaleLayout {
  int columns = 1;  // 1 to kMaxScaleColumns
  int rows = 2;     // even, 2 to kMaxScaleColumns
  // 0 is the hexagonal grid. Above it, up to 1, is blue noise, with no two centres nearer than 1 - 0.3
  // jitter.
  double jitter = 0;
  std::uint64_t seed = 1;  // of the blue noise
  ScalePattern pattern = ScalePattern::grid;
};
inline constexpr int kMaxScaleColumns = 512;

Point2 tile_size(const ScaleLayout& layout);
double min_center_distance(const ScaleLayout& layout);

// Returns the centres of the cells within one tile. Blue noise is a hard-disk fluid (Metropolis et al. 1953)
// that starts from the grid: centres move at random, and a step is taken only if it keeps the distance from
// all others, so the number of cells is exact and the distance holds for every seed.
std::vector<Point2> scale_centers(const ScaleLayout& layout);

// Returns one tile, with heights in [0, 1]. A cell is highest in its middle and falls to 0 at its border,
// over the distance `edge` in (0, 0.5]: 0.5 is a dome, less a plateau. Near a border at the distance d its
// height is 1 - (1 - d/edge)^2, the product over all borders, so that ridges do not form towards the corners.
// The pixels are as square as whole numbers allow, `pixels_per_scale` (4 to 256) to a scale width.
HeightMap scale_height_map(const ScaleLayout& layout, double edge, int pixels_per_scale);

}  // namespace sunbeam
