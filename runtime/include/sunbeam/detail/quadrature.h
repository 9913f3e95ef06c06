// This file holds Gauss-Legendre quadrature on [0, 1]: Int_0^1 f dx = sum weight f(node), exact for
// polynomials of degree 2 count - 1. Newton's method on the Legendre recurrence (DLMF 3.5(v)) finds the
// nodes, to rounding. Interpolation goes through the same nodes by the barycentric formula (Berrut and
// Trefethen 2004).
#pragma once

#include <array>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

struct GaussRule {
  std::vector<double> node, weight;  // nodes ascend
  int size() const { return static_cast<int>(node.size()); }
};

inline GaussRule gauss_legendre(int count) {
  GaussRule rule{std::vector<double>(count), std::vector<double>(count)};
  for (int i = 0; i < count; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (count + 0.5)), slope = 1;  // a root of P_count, descending
    for (int step = 0; step < 8; ++step) {                             // quadratic from a close start
      double p = 1, before = 0;
      for (int k = 1; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.node[count - 1 - i] = (1 + x) / 2;
    rule.weight[count - 1 - i] = 1 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

class GaussInterpolation {
 public:
  static constexpr int kMaxCount = 24;
  using Weights = std::array<double, kMaxCount>;

  explicit GaussInterpolation(int count) : rule_(gauss_legendre(count)) {
    barycentric_.fill(1);
    for (int k = 0; k < count; ++k)
      for (int j = 0; j < count; ++j)
        if (j != k) barycentric_[k] /= 4 * (rule_.node[k] - rule_.node[j]);
  }

  const GaussRule& rule() const { return rule_; }
  int size() const { return rule_.size(); }

  // Returns the weights of the polynomial through f at the nodes: at x it is sum weights[k] f(node[k]).
  Weights at(double x) const {
    Weights weights{};
    double sum = 0;
    for (int k = 0; k < size(); ++k) {
      const double gap = x - rule_.node[k];
      if (gap == 0) {
        weights.fill(0);
        weights[k] = 1;
        return weights;
      }
      sum += weights[k] = barycentric_[k] / gap;
    }
    for (int k = 0; k < size(); ++k) weights[k] /= sum;
    return weights;
  }

 private:
  GaussRule rule_;
  Weights barycentric_;
};

}  // namespace v1
}  // namespace sunbeam
