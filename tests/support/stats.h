// Statistics of random tests: running means, chi-square, correction for many tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam::test {

// Mean and its standard error in one pass (Welford).
class RunningMean {
 public:
  void add(double x) {
    ++count_;
    const double delta = x - mean_;
    mean_ += delta / static_cast<double>(count_);
    squares_ += delta * (x - mean_);
  }
  std::int64_t count() const { return count_; }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }
  double std_error() const { return count_ > 1 ? std::sqrt(variance() / static_cast<double>(count_)) : 0; }

 private:
  std::int64_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

// Regularised upper incomplete gamma function Q(a, x) = Gamma(a, x) / Gamma(a), a > 0, x >= 0: the power
// series of 1 - Q below the mean, Legendre's continued fraction (Lentz's method) above (DLMF 8.7.1, 8.9.2).
inline double gamma_q(double a, double x) {
  if (x <= 0) return 1;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; term > sum * 1e-16; ++n) sum += term *= x / (a + n);
    return 1 - front * sum;
  }
  constexpr double kTiny = 1e-300;
  double b = x + 1 - a, c = 1 / kTiny, d = 1 / b, fraction = d;
  for (int n = 1; n < 100000; ++n) {
    const double step = -n * (n - a);
    b += 2;
    d = step * d + b;
    c = b + step / c;
    if (std::abs(d) < kTiny) d = kTiny;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1 / d;
    fraction *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return front * fraction;
}

// P(a chi-square variable of `degrees` degrees of freedom exceeds `statistic`).
inline double chi_square_tail(double statistic, int degrees) { return gamma_q(degrees / 2.0, statistic / 2); }

// Level of one test so that `count` independent ones raise a false alarm with probability `level` in all.
inline double sidak(double level, int count) { return -std::expm1(std::log1p(-level) / count); }

// Two-sided p-value of a normal deviate, for differences measured in standard errors.
inline double normal_tail(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

// One cell of a histogram: a Poisson count against an expected count that has an error of its own.
struct Cell {
  double observed = 0;
  double expected = 0;
  double expected_variance = 0;  // of `expected` as an estimate; 0 if exact
};

struct ChiSquare {
  double statistic = 0;
  int degrees = 0;  // cells left after pooling
  double p_value = 1;
};

// Pearson's statistic of independent Poisson cells; cells that expect fewer than `least` are pooled into one.
// Totals are not fixed, so every cell is a degree of freedom. An outcome where none is expected gives p = 0.
inline ChiSquare chi_square(const std::vector<Cell>& cells, double least = 10) {
  ChiSquare result;
  Cell thin;
  const auto add = [&](const Cell& cell) {
    result.statistic += square(cell.observed - cell.expected) / (cell.expected + cell.expected_variance);
    ++result.degrees;
  };
  for (const Cell& cell : cells) {
    if (cell.expected >= least) {
      add(cell);
    } else {
      thin.observed += cell.observed;
      thin.expected += cell.expected;
      thin.expected_variance += cell.expected_variance;
    }
  }
  if (thin.expected >= 1)
    add(thin);
  else if (thin.observed > 20)  // expecting < 1: a false alarm of less than 1e-19
    return {std::numeric_limits<double>::infinity(), result.degrees, 0};
  result.p_value = result.degrees > 0 ? chi_square_tail(result.statistic, result.degrees) : 0;
  return result;
}

}  // namespace sunbeam::test
