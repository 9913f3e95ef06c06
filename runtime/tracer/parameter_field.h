// A parameter field is a number that varies over a surface: from + (to - from) * s, with s in [0, 1] from a
// picture or a pattern at the texture coordinates (u, v).
#pragma once

#include <memory>
#include <utility>

#include "runtime/tracer/height_map.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

struct ParameterField {
  // Says how s follows from (u, v), with x = along.x u + along.y v for ramp and bands.
  //   constant  s = 0, and `from` is the value.
  //   ramp      s = x, held at 0 and 1.
  //   bands     s = (1 - cos 2 pi x) / 2, a full band where x grows by 1.
  //   map       s is the map, repeated along.x times along u and along.y times along v, filtered as HeightMap
  //             says, held at 0 and 1.
  enum class Kind { constant, ramp, bands, map };

  Kind kind = Kind::constant;
  double from = 0, to = 0;
  Point2 along;
  std::shared_ptr<const HeightMap> map;

  static ParameterField of(double value) { return {.from = value, .to = value, .along = {}, .map = {}}; }
  bool is_constant() const { return kind == Kind::constant; }
  double at(const Point2& uv) const;
  // Returns the lowest and the highest value it can take.
  std::pair<double, double> bounds() const;
};

// Returns smooth noise that repeats in both directions, for ParameterField::map: `octaves` layers of values
// on a grid of `cells`, 2 cells, 4 cells ... across, each half as strong as the one before, stretched to [0,
// 1]. cells and octaves are >= 1, and cells << octaves is at most 512. What is random in it depends on `seed`
// alone.
HeightMap noise_map(int cells, int octaves, std::uint64_t seed);

}  // namespace sunbeam
