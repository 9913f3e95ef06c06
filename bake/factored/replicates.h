// This file collects independent estimates of the same numbers, whose spread is their noise.
#pragma once

#include <algorithm>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {

inline constexpr std::size_t kReplicates = 4;

// Keeps the mean of replicates and the variance of that mean.
class Replicates {
 public:
  explicit Replicates(std::size_t size) : sum_(size), squares_(size) {}

  void add(const std::vector<double>& one) {
    for (std::size_t k = 0; k < sum_.size(); ++k) {
      sum_[k] += one[k] / kReplicates;
      squares_[k] += square(one[k]) / kReplicates;
    }
  }
  const std::vector<double>& mean() const { return sum_; }
  double variance(std::size_t k) const {
    return std::max(0.0, squares_[k] - square(sum_[k])) / (kReplicates - 1);
  }

 private:
  std::vector<double> sum_, squares_;
};

// Bounds the strata of a replicate, which are doubled until the noise is low enough.
struct Strata {
  std::size_t least, most;
};

}  // namespace sunbeam
