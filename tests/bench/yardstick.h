// What every time is compared with: one trilinear look-up of half-float RGB that never leaves the first
// cache, 16 x 16 x 16 nodes, at coordinates drawn beforehand. No angles, no BSDF.
#pragma once

#include <array>

#include "sunbeam/core/rng.h"
#include "tests/bench/half_grid.h"

namespace sunbeam {

class Yardstick {
 public:
  static constexpr std::size_t kNodes = 16;

  Yardstick() {
    Rng rng(16, 0);
    for (std::size_t i = 0; i < kNodes; ++i)
      for (std::size_t j = 0; j < kNodes; ++j)
        for (std::size_t k = 0; k < kNodes; ++k)
          grid_.set({i, j, k}, {rng.uniform(), rng.uniform(), rng.uniform()});
    for (auto& point : points_) point = {rng.uniform(), rng.uniform(), rng.uniform()};
  }

  Rgb operator()(std::size_t call) const {
    const auto& [x, y, z] = points_[call % points_.size()];
    return grid_(x, y, z);
  }

 private:
  HalfGrid grid_{{kNodes, kNodes, kNodes}};
  std::array<std::array<double, 3>, 256> points_;
};

}  // namespace sunbeam
