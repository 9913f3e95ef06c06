// This file looks up the rest of a factored table over all its parameters: the arrays L and X of
// sunbeam/textured_table.h, which runtime/src/fit/textured_fit.h makes.
#pragma once

#include <array>
#include <vector>

#include "runtime/src/base/exp4.h"
#include "runtime/src/rest/packed_nodes.h"
#include "runtime/src/rest/pair_taps.h"
#include "runtime/src/rest/textured_grid.h"
#include "runtime/src/rest/textured_media.h"
#include "sunbeam/detail/textured_point.h"

namespace sunbeam {
inline namespace v1 {

class TexturedRest {
 public:
  TexturedRest(const Table& table, Arithmetic arithmetic);

  // Says whether the table is isotropic and of path "sum": then L says all, whatever the azimuth.
  bool is_plain() const { return grid_.phis == 1 && pairs_.empty(); }
  bool is_product() const { return !pairs_.empty(); }

  ParameterTaps parameter_taps(const Parameters& at) const;

  // Says where a direction lies among the nodes.
  struct Direction {
    EvenPosition path, cosine;
  };
  // Locates a direction: `path` is the root of FilmCosines::path_squared, `coordinate` the warped
  // cosine or the root of it.
  Direction direction(const ParameterTaps& taps, float path, float coordinate) const {
    return {grid_.locate_path(taps.thickness_nm, path), {coordinate, grid_.cosines}};
  }

  // Returns L; the last lane is the chance of sampling the first surface, interpolated too.
  Color4 at(const ParameterTaps& taps, const Direction& w) const {
    const PackedWeights weights(taps.absorption, w.cosine.upper_weight);
    const std::size_t first = first_node(taps, w);
    const auto blend = [&](std::size_t node) { return nodes_.blend(weights, node, node + per_absorption_); };
    const Color4 low[] = {blend(first), blend(first + per_ior_)},
                 high[] = {blend(first + per_path_), blend(first + per_path_ + per_ior_)};
    const Color4 lower = low[0] + taps.base_ior * (low[1] - low[0]),
                 upper = high[0] + taps.base_ior * (high[1] - high[0]);
    return nodes_.value(lower + w.path.upper_weight * (upper - lower));
  }

  // Returns the same of an anisotropic film; `phi` is the azimuth folded into a quadrant, over pi/2.
  Color4 at(const ParameterTaps& taps, const Direction& w, float phi) const {
    if (grid_.phis == 1) return at(taps, w);
    const EvenPosition azimuth(phi, grid_.phis);
    ParameterTaps lower = taps, upper = taps;
    lower.row += static_cast<std::size_t>(azimuth.lower * grid_.cosines);
    upper.row = lower.row + static_cast<std::size_t>(grid_.cosines);
    const Color4 low = at(lower, w);
    return low + azimuth.upper_weight * (at(upper, w) - low);
  }

  // exchange() returns X of two directions, each given by its coordinate and by phi as above.
  struct PairEnd {
    float coordinate, phi;
  };
  Color4 exchange(const Parameters& at, const PairEnd& o, const PairEnd& i) const;

  // Returns the chance of sampling the first surface, from the nearest parameters: they are given, and so the
  // choice need not change smoothly with them.
  float first_chance(const ParameterTaps& taps, const Direction& w) const {
    const auto path = static_cast<std::size_t>(w.path.lower + (w.path.upper_weight < 0.5f ? 0 : 1));
    return nodes_.last_lane(taps.nearest + path * per_path_ + static_cast<std::size_t>(w.cosine.lower),
                            w.cosine.upper_weight);
  }

  // Asks for what at() will read, to work meanwhile.
  void prefetch(const ParameterTaps& taps, const Direction& w) const {
    const std::size_t first = first_node(taps, w);
    for (const std::size_t path : {first, first + per_path_})
      for (const std::size_t row : {path, path + per_ior_}) {
        sunbeam::prefetch(nodes_.address(row));
        sunbeam::prefetch(nodes_.address(row + per_absorption_));
      }
  }

  const TexturedMedia& media() const { return media_; }
  const EvenAxis& axis(std::size_t k) const { return grid_.axes[k]; }
  std::size_t bytes() const { return nodes_.bytes() + pairs_.size() * sizeof(Color4); }

 private:
  // Returns the lowest of a direction's neighbours.
  std::size_t first_node(const ParameterTaps& taps, const Direction& w) const {
    return taps.row + static_cast<std::size_t>(w.path.lower) * per_path_ +
           static_cast<std::size_t>(w.cosine.lower);
  }

  TexturedGrid grid_;
  TexturedMedia media_;
  std::size_t per_path_, per_ior_, per_absorption_;  // from node to node of L
  PackedNodes nodes_;                                // L: (path, base_ior, absorption_per_nm, phi, cosine)
  // Only path "product" has them: (film_thickness_nm, base_ior, absorption_per_nm, direction, direction),
  // with directions as (phi, cosine).
  std::vector<Color4> pairs_;
};

}  // namespace v1
}  // namespace sunbeam
