// This file cuts polygons of mesh files into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {

// A cutter keeps its memory from one polygon to the next.
class PolygonCutter {
 public:
  static constexpr std::uint64_t kBytesPerCorner = 160;  // of the largest polygon, the caller's included

  PolygonCutter();
  ~PolygonCutter();

  // Cuts a polygon into corners.size() - 2 triangles, each three places in `corners`, wound as the polygon
  // is. The result holds until the next call; it is empty for fewer than three corners. A convex polygon
  // becomes a fan about its first corner, any other is cut by ear clipping in its own plane, that of Newell's
  // normal. Repeated corners, corners on a line and edges that run back on each other, as towards a hole, are
  // right; triangles without area may come of them. A polygon that crosses itself is cut somehow.
  const std::vector<std::array<std::uint32_t, 3>>& cut(const std::vector<Vec3>& corners);

 private:
  class EarClipping;

  void cut_fan(std::size_t corners);

  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::unique_ptr<EarClipping> ear_clipping_;
};

}  // namespace sunbeam
