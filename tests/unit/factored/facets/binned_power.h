// Power by pigment depth and by the rank of the facets that it meets: drawn leg by leg, or by quadrature.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sunbeam/detail/factors.h"
#include "sunbeam/detail/quadrature.h"
#include "tests/support/stats.h"

namespace sunbeam::test {

inline constexpr std::size_t kBins = 6, kNodesOfABin = 8, kRuns = 32;
inline const std::vector<double> kDepths{0, 0.2, 1.5};

// Bins of equal ranks, and in each of them a rule over the share v of facets.
struct BinnedRanks {
  std::vector<double> edges, nodes, weights;

  BinnedRanks() {
    const GaussRule rule = gauss_legendre(kNodesOfABin);
    for (std::size_t bin = 0; bin <= kBins; ++bin) edges.push_back(double(bin) / kBins);
    for (std::size_t bin = 0; bin < kBins; ++bin)
      for (std::size_t i = 0; i < kNodesOfABin; ++i) {
        nodes.push_back((double(bin) + rule.node[i]) / kBins);
        weights.push_back(rule.weight[i] / kBins * share_slope(nodes.back()));
      }
  }

  // The sum over each bin of weight * value(depth, node).
  template <class Value>
  std::vector<double> sums(Value value) const {
    std::vector<double> power(kDepths.size() * kBins);
    for (std::size_t t = 0; t < kDepths.size(); ++t)
      for (std::size_t j = 0; j < nodes.size(); ++j)
        power[t * kBins + j / kNodesOfABin] += weights[j] * value(t, j);
    return power;
  }
};

// The bin of a cosine, by the cosines at the edges of bins.
inline std::size_t bin_of(const std::vector<double>& edges, double cosine) {
  const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, cosine);
  return static_cast<std::size_t>(above - edges.begin()) - 1;
}

// The mean over runs of what legs bring.
class DrawnPower {
 public:
  // add(power) is one run, whose power it adds to (depth, bin).
  template <class Add>
  explicit DrawnPower(Add add) : cells_(kDepths.size() * kBins) {
    for (std::size_t run = 0; run < kRuns; ++run) {
      std::vector<double> power(cells_.size());
      add(run, power);
      for (std::size_t k = 0; k < cells_.size(); ++k) cells_[k].add(power[k]);
    }
  }

  double mean(std::size_t depth, std::size_t bin) const { return cells_[depth * kBins + bin].mean(); }

  // Within six standard errors: with 32 runs, one in 800000 is beyond. Quadratures may be off by 0.1 %, and
  // what is darker than 1e-6 is not told apart.
  void expect(std::size_t depth, std::size_t bin, double expected, const std::string& what) const {
    const double error = cells_[depth * kBins + bin].std_error();
    EXPECT_NEAR(mean(depth, bin), expected, 6 * error + 1e-3 * expected + 1e-6)
        << what << ", depth " << kDepths[depth] << ", bin " << bin;
  }

 private:
  std::vector<RunningMean> cells_;
};

}  // namespace sunbeam::test
