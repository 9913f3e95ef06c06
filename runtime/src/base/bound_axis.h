// This is an axis as look-ups want it: the nodes that a value lies between are found without a search, and
// their weights come from differences and factors known beforehand. Weights are those of Axis::stencil in
// single floats; places are in doubles, for a float of an azimuth is off by 2e-7 of a radian.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sunbeam/detail/axis.h"

namespace sunbeam {
inline namespace v1 {

class BoundAxis {
 public:
  struct Taps {
    int count;
    std::array<int, 4> offset;
    std::array<float, 4> weight;
  };

  BoundAxis() = default;
  // Prepares an axis. Offsets are node numbers times `stride`.
  BoundAxis(const Axis& axis, std::size_t stride);

  Taps at(double x) const {
    const double u = clamped_coordinate(x);
    std::size_t k = guide_[static_cast<std::size_t>((u - low_) * cells_per_unit_)];
    while (k + 1 < intervals_.size() && u >= intervals_[k + 1].begin) ++k;
    const Interval& interval = intervals_[k];
    Taps taps{interval.count, interval.offset, interval.factor};
    const auto inside = static_cast<float>(u - interval.begin);
    std::array<float, 4> d;
    for (int j = 0; j < 4; ++j) d[j] = inside - interval.u[j];
    if (interval.count == 4) {
      const float low = d[0] * d[1], high = d[2] * d[3];
      taps.weight[0] *= d[1] * high;
      taps.weight[1] *= d[0] * high;
      taps.weight[2] *= low * d[3];
      taps.weight[3] *= low * d[2];
    } else {
      for (int i = 0; i < interval.count; ++i)
        for (int j = 0; j < interval.count; ++j)
          if (i != j) taps.weight[i] *= d[j];
    }
    return taps;
  }

 private:
  static constexpr int kGuideCells = 64;

  // Describes the interval between two neighbours, with all nodes that values there are made of.
  struct Interval {
    double begin = 0;  // coordinate
    int count = 1;
    std::array<int, 4> offset{};              // of the nodes,
    std::array<float, 4> u{};                 // their coordinates from there
    std::array<float, 4> factor{1, 0, 0, 0};  // and 1 / product of differences to the others
  };

  double clamped_coordinate(double x) const {
    if (period_ > 0) x -= period_ * std::floor((x - first_) / period_);
    const double offset = x - origin_;
    double u = offset;
    if (softness_ > 0)
      u = offset / std::sqrt(std::abs(offset) + softness_);
    else if (power_ == 2)
      u = std::copysign(std::sqrt(std::abs(offset)), offset);
    else if (power_ != 1)
      u = std::copysign(std::pow(std::abs(offset), 1 / power_), offset);
    return std::min(std::max(u, low_), high_);
  }

  double power_ = 1, period_ = 0, origin_ = 0, first_ = 0, softness_ = 0;
  double low_ = 0, high_ = 0, cells_per_unit_ = 0;
  std::vector<Interval> intervals_{1};
  std::array<std::uint16_t, kGuideCells + 1> guide_{};  // the interval in which each even cell begins
};

}  // namespace v1
}  // namespace sunbeam
