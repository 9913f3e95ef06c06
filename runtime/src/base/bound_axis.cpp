#include "runtime/src/base/bound_axis.h"

#include <algorithm>

namespace sunbeam {
inline namespace v1 {

BoundAxis::BoundAxis(const Axis& axis, std::size_t stride)
    : power_(axis.power),
      period_(axis.period),
      origin_(axis.origin),
      first_(axis.nodes.front()),
      softness_(axis.softness) {
  const std::size_t n = axis.size();
  const bool wraps = axis.period > 0 && n > 1;
  const std::size_t most = axis.is_cubic ? 4 : 2;
  const auto coordinate = [&](std::size_t node) {
    return axis.coordinate(axis.nodes[node % n] + (node < n ? 0 : axis.period));
  };
  low_ = coordinate(0);
  high_ = coordinate(wraps ? n : n - 1);

  intervals_.assign(n == 1 ? 1 : wraps ? n : n - 1, {});
  for (std::size_t k = 0; k < intervals_.size(); ++k) {
    Interval& interval = intervals_[k];
    interval.begin = coordinate(k);
    const Axis::Run run = axis.smooth_run(k);
    const std::size_t count = std::min(run.count, most);
    interval.count = static_cast<int>(count);
    const std::size_t first =
        count > 2 ? std::clamp(k, run.first + 1, run.first + run.count - count + 1) - 1 : k;
    for (std::size_t i = 0; i < count; ++i) {
      interval.offset[i] = static_cast<int>((first + i) % n * stride);
      interval.u[i] = static_cast<float>(coordinate(first + i) - interval.begin);
      double factor = 1;
      for (std::size_t j = 0; j < count; ++j)
        if (j != i) factor /= coordinate(first + i) - coordinate(first + j);
      interval.factor[i] = static_cast<float>(factor);
    }
  }
  if (n == 1) return;
  cells_per_unit_ = kGuideCells / (high_ - low_);
  for (int cell = 0; cell <= kGuideCells; ++cell) {
    const double begin = low_ + cell / cells_per_unit_;
    const auto beyond = std::upper_bound(intervals_.begin() + 1, intervals_.end(), begin,
                                         [](double u, const Interval& i) { return u < i.begin; });
    // One too early does no harm: rounding must not make it one too late.
    const auto interval = beyond - intervals_.begin() - 1;
    guide_[cell] = static_cast<std::uint16_t>(std::max<std::ptrdiff_t>(0, interval - 1));
  }
}

}  // namespace v1
}  // namespace sunbeam
