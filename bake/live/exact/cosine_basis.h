// This file represents functions of a cosine mu in [0, 1] by their values at nodes. They are polynomials on
// panels, and the nodes are the Gauss points of each.
//
// Panels halve towards mu = 0, where exp(-tau / mu) has its essential singularity, and towards mu = 1, where
// it peaks when tau is large. With 10 nodes a panel exp(-x / mu) is interpolated to 1e-7 of its maximum for
// 0 <= x <= 60, save on the last panel [0, 1/64], whose share of a cosine-weighted integral is below 3e-4.
#pragma once

#include <array>
#include <vector>

#include "sunbeam/detail/quadrature.h"

namespace sunbeam {

class CosineBasis {
 public:
  static constexpr std::array<double, 11> kEdges{0,       1.0 / 64, 1.0 / 32, 1.0 / 16,  1.0 / 8, 1.0 / 4,
                                                 1.0 / 2, 3.0 / 4,  7.0 / 8,  15.0 / 16, 1};
  static constexpr int kPanels = static_cast<int>(kEdges.size()) - 1;

  explicit CosineBasis(int per_panel) : panel_(per_panel) {
    for (int p = 0; p < kPanels; ++p)
      for (int k = 0; k < per_panel; ++k) {
        nodes_.push_back(lerp(panel_.rule().node[k], kEdges[p], kEdges[p + 1]));
        cosine_weights_.push_back(2 * kPi * nodes_.back() * panel_.rule().weight[k] *
                                  (kEdges[p + 1] - kEdges[p]));
      }
  }

  int size() const { return static_cast<int>(nodes_.size()); }
  int per_panel() const { return panel_.size(); }
  const std::vector<double>& nodes() const { return nodes_; }
  // Returns the weights of a quadrature: Int f(mu) 2 pi mu dmu = sum of these times f(node).
  const std::vector<double>& cosine_weights() const { return cosine_weights_; }

  // Holds the weights of a value: f(mu) = sum_k weight[k] f(node[first + k]), k < per_panel().
  struct Stencil {
    int first;
    GaussInterpolation::Weights weight;
  };
  Stencil at(double mu) const {
    int p = 0;
    while (p + 1 < kPanels && mu >= kEdges[p + 1]) ++p;
    return {p * per_panel(), panel_.at((mu - kEdges[p]) / (kEdges[p + 1] - kEdges[p]))};
  }

 private:
  GaussInterpolation panel_;
  std::vector<double> nodes_, cosine_weights_;
};

}  // namespace sunbeam
