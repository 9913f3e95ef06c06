// This file looks up the rest of a factored table over all its parameters: the arrays L and X of
// sunbeam/textured_table.h, which runtime/src/fit/textured_fit.h makes.
#pragma once

#include <array>
#include <vector>

#include "runtime/src/base/exp4.h"
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
    const Color4* first = nodes_.data() + taps.row + w.path.lower * stride_ + w.cosine.lower;
    const Color4* second = first + stride_;
    Color4 low[2]{}, high[2]{};
    for (std::size_t k = 0; k < 4; ++k) {
      const Color4 weight = taps.weight[k] + Color4{};
      low[0] += weight * first[corner_[k]];
      high[0] += weight * first[corner_[k] + 1];
      low[1] += weight * second[corner_[k]];
      high[1] += weight * second[corner_[k] + 1];
    }
    for (int k = 0; k < 2; ++k) low[k] += w.cosine.upper_weight * (high[k] - low[k]);
    return low[0] + w.path.upper_weight * (low[1] - low[0]);
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
    const int path = w.path.lower + (w.path.upper_weight < 0.5f ? 0 : 1);
    const Color4* row = nodes_.data() + taps.nearest + path * stride_ + w.cosine.lower;
    return row[0][3] + w.cosine.upper_weight * (row[1][3] - row[0][3]);
  }

  // Asks for what at() will read, to work meanwhile.
  void prefetch(const ParameterTaps& taps, const Direction& w) const {
    const Color4* first = nodes_.data() + taps.row + w.path.lower * stride_ + w.cosine.lower;
    for (const int corner : corner_) {
      sunbeam::prefetch(first + corner);
      sunbeam::prefetch(first + corner + stride_);
    }
  }

  const TexturedMedia& media() const { return media_; }
  const EvenAxis& axis(std::size_t k) const { return grid_.axes[k]; }
  std::size_t bytes() const { return (nodes_.size() + pairs_.size()) * sizeof(Color4); }

 private:
  TexturedGrid grid_;
  TexturedMedia media_;
  int stride_;                 // from path to path, in nodes
  std::array<int, 4> corner_;  // distance of a place's rows from the first
  std::vector<Color4> nodes_;  // (path, base_ior, absorption_per_nm, phi, cosine)
  // Only path "product" has them: (film_thickness_nm, base_ior, absorption_per_nm, direction, direction),
  // with directions as (phi, cosine).
  std::vector<Color4> pairs_;
};

}  // namespace v1
}  // namespace sunbeam
