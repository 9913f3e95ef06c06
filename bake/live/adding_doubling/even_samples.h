// This file says where a smooth even function of u >= 0 is known, and with which weights what is known enters
// its value elsewhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sunbeam {

class EvenSamples {
 public:
  static constexpr int kStencil = 8;
  struct Stencil {
    int count = 0;  // 1 or kStencil
    std::array<std::size_t, kStencil> node{};
    std::array<double, kStencil> weight{};
  };

  // Knows the function at these values alone (ascending).
  explicit EvenSamples(std::vector<double> values) : node_(std::move(values)) {}
  // Knows the function in equal steps from 0 to beyond `largest`. In between are polynomials of degree 7,
  // which go through the mirrored nodes near 0.
  EvenSamples(double step, double largest) : step_(step) {
    const int last = static_cast<int>(std::ceil(largest / step)) + kStencil / 2;
    for (int k = 0; k <= last; ++k) node_.push_back(k * step);
  }

  std::size_t size() const { return node_.size(); }
  double operator[](std::size_t k) const { return node_[k]; }

  // Returns the nodes and weights of the value at u, which must be one of the values, or up to `largest`.
  Stencil at(double u) const {
    Stencil s;
    if (step_ == 0) {
      s.count = 1;
      s.node[0] = static_cast<std::size_t>(std::lower_bound(node_.begin(), node_.end(), u) - node_.begin());
      s.weight[0] = 1;
      return s;
    }
    s.count = kStencil;
    const double x = u / step_;
    const int first = static_cast<int>(x) - kStencil / 2 + 1;
    for (int i = 0; i < kStencil; ++i) {
      s.node[i] = static_cast<std::size_t>(std::abs(first + i));
      s.weight[i] = 1;
      for (int j = 0; j < kStencil; ++j)
        if (j != i) s.weight[i] *= (x - (first + j)) / (i - j);
    }
    return s;
  }

 private:
  std::vector<double> node_;
  double step_ = 0;  // 0: at the nodes alone
};

}  // namespace sunbeam
