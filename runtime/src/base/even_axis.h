// This file puts a parameter of a table on nodes that are even in a coordinate, so that a value is located
// without a search.
#pragma once

#include "runtime/src/base/color4.h"
#include "sunbeam/detail/axis.h"

namespace sunbeam {
inline namespace v1 {

class EvenAxis {
 public:
  // Spreads `nodes` over the range of `axis`; where the axis bends (power > 1) they are even in the root of
  // what is beyond its origin.
  EvenAxis(const Axis& axis, int nodes)
      : low_(axis.low()), high_(axis.high()), origin_(axis.origin), is_root_(axis.power > 1), nodes_(nodes) {
    first_ = coordinate(low_);
    extent_ = coordinate(high_) - first_;
    per_extent_ = extent_ > 0 ? 1 / extent_ : 0;
  }

  int size() const { return nodes_; }
  double low() const { return low_; }
  double high() const { return high_; }
  double node(int k) const {
    const double u = first_ + extent_ * k / (nodes_ - 1);
    return clamped(is_root_ ? origin_ + u * u : u);
  }
  // Clamps x to the axis; what is not a number counts as high.
  double clamped(double x) const { return std::max(low_, std::min(high_, x)); }
  // Returns the place of x in [low, high].
  EvenPosition locate(double x) const {
    return EvenPosition(static_cast<float>((coordinate(x) - first_) * per_extent_), nodes_);
  }

 private:
  double coordinate(double x) const { return is_root_ ? std::sqrt(std::max(0.0, x - origin_)) : x; }

  double low_, high_, origin_, first_ = 0, extent_ = 0, per_extent_ = 0;
  bool is_root_;
  int nodes_;
};

}  // namespace v1
}  // namespace sunbeam
