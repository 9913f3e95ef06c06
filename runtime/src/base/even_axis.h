// This file puts a parameter of a table on nodes that are even in a coordinate, so that a value is located
// without a search.
#pragma once

#include <cmath>

#include "runtime/src/base/color4.h"
#include "sunbeam/detail/axis.h"

namespace sunbeam {
inline namespace v1 {

class EvenAxis {
 public:
  // Spreads `nodes` over the range of `axis`; where the axis bends (power > 1) they are even in the root of
  // what is beyond its origin. An origin within the axis is a node, and either side is even by itself.
  EvenAxis(const Axis& axis, int nodes)
      : low_(axis.low()), high_(axis.high()), origin_(axis.origin), is_root_(axis.power > 1), nodes_(nodes) {
    first_ = coordinate(low_);
    const double last = coordinate(high_);
    if (is_root_ && first_ < 0 && last > 0)
      below_ = static_cast<int>(intervals_below(static_cast<std::size_t>(nodes - 1), -first_, last));
    extent_ = below_ > 0 ? last : last - first_;
    per_extent_ = extent_ > 0 ? 1 / extent_ : 0;
  }

  int size() const { return nodes_; }
  double low() const { return low_; }
  double high() const { return high_; }
  double node(int k) const {
    const double u = k < below_   ? first_ - first_ * k / below_
                     : below_ > 0 ? extent_ * (k - below_) / (nodes_ - 1 - below_)
                                  : first_ + extent_ * k / (nodes_ - 1);
    return clamped(is_root_ ? origin_ + std::copysign(u * u, u) : u);
  }
  // Clamps x to the axis; what is not a number counts as high.
  double clamped(double x) const { return std::max(low_, std::min(high_, x)); }
  // Returns the place of x in [low, high].
  EvenPosition locate(double x) const {
    const double u = coordinate(x);
    if (below_ == 0) return EvenPosition(static_cast<float>((u - first_) * per_extent_), nodes_);
    const double kink = static_cast<double>(below_) / (nodes_ - 1);
    const double place = u < 0 ? kink * (1 - u / first_) : kink + (1 - kink) * u * per_extent_;
    return EvenPosition(static_cast<float>(place), nodes_);
  }

 private:
  double coordinate(double x) const {
    if (!is_root_) return x;
    return std::copysign(std::sqrt(std::abs(x - origin_)), x - origin_);
  }

  double low_, high_, origin_, first_ = 0, extent_ = 0, per_extent_ = 0;
  bool is_root_;
  int nodes_, below_ = 0;  // intervals below an origin within the axis
};

}  // namespace v1
}  // namespace sunbeam
