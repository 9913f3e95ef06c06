// This file holds piecewise-constant densities on [0, 1), with sample, pdf and inverse.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace sunbeam {
inline namespace v1 {

class PiecewiseConstant {
 public:
  PiecewiseConstant() = default;

  // Makes the density proportional to `weights` (finite, >= 0) over equal bins; all zero means uniform.
  explicit PiecewiseConstant(std::span<const double> weights) : cdf_(weights.size() + 1, 0.0) {
    for (std::size_t i = 0; i < weights.size(); ++i) cdf_[i + 1] = cdf_[i] + weights[i];
    integral_ = cdf_.back() / static_cast<double>(size());
    for (std::size_t i = 1; i < cdf_.size(); ++i)
      cdf_[i] = integral_ > 0 ? cdf_[i] / cdf_.back() : static_cast<double>(i) / static_cast<double>(size());
    cdf_.back() = 1;
  }

  std::size_t size() const { return cdf_.size() - 1; }

  // Returns the integral of the unnormalised weights over [0, 1).
  double integral() const { return integral_; }

  double sample(double u) const {
    const auto above = std::upper_bound(cdf_.begin(), cdf_.end() - 1, u);
    const auto bin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, above - cdf_.begin() - 1));
    const double width = cdf_[bin + 1] - cdf_[bin];
    const double within = width > 0 ? (u - cdf_[bin]) / width : 0.5;
    return std::min((static_cast<double>(bin) + within) / static_cast<double>(size()), kBelowOne);
  }

  double pdf(double x) const {
    const std::size_t bin = bin_of(x);
    return (cdf_[bin + 1] - cdf_[bin]) * static_cast<double>(size());
  }

  double invert(double x) const {
    const std::size_t bin = bin_of(x);
    const double within = x * static_cast<double>(size()) - static_cast<double>(bin);
    return cdf_[bin] + within * (cdf_[bin + 1] - cdf_[bin]);
  }

 private:
  static constexpr double kBelowOne = 1 - 0x1p-53;

  std::size_t bin_of(double x) const {
    const auto bin = static_cast<std::ptrdiff_t>(x * static_cast<double>(size()));
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(bin, 0, static_cast<std::ptrdiff_t>(size()) - 1));
  }

  std::vector<double> cdf_;
  double integral_ = 0;
};

}  // namespace v1
}  // namespace sunbeam
