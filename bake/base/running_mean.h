// This class keeps the running mean of one tabulated value and says how well it is known.
#pragma once

#include "bake/base/error_floor.h"

namespace sunbeam {

class RunningMean {
 public:
  void add(const Rgb& estimate) {
    sum_ += estimate;
    sum_of_squares_ += estimate * estimate;
  }

  Rgb mean_of(double count) const { return sum_ / count; }

  Rgb standard_error(double count) const {
    return transform(sum_of_squares_ / count - square_each(mean_of(count)),
                     [count](double variance) { return std::sqrt(std::max(0.0, variance) / (count - 1)); });
  }

  // Returns the standard error, averaged over channels, relative to the mean value or to kDarkestValue if
  // that is larger.
  double relative_error(double count) const {
    return mean(standard_error(count)) / std::max(mean_abs(mean_of(count)), kDarkestValue);
  }

  // Says whether the value is known to `noise`: this is the stop rule.
  bool is_known(double noise, double count) const { return relative_error(count) <= noise; }

 private:
  static Rgb square_each(const Rgb& x) { return x * x; }

  Rgb sum_, sum_of_squares_;
};

}  // namespace sunbeam
