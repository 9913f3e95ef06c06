#include "bake/live/walks/base_guide.h"

namespace sunbeam::walk {
namespace {

std::array<std::array<double, kLanes>, kStrata> make_strata() {
  std::array<std::array<double, kLanes>, kStrata> rows{};
  Rng rng(0x5eed, 0);
  for (auto& row : rows) {
    for (int lane = 0; lane < kLanes; ++lane) row[lane] = (lane + rng.uniform()) / kLanes;
    for (int lane = kLanes - 1; lane > 0; --lane)
      std::swap(row[lane], row[static_cast<int>(rng.uniform() * (lane + 1))]);
  }
  return rows;
}

}  // namespace

const std::array<std::array<double, kLanes>, kStrata> kStratum = make_strata();

Guide::Guide(const std::array<double, kBins>& importance) {
  double sum = 0;
  for (const double value : importance) sum += value;
  const auto probability = [&](int bin) {
    return kCosineShare / kBins + (1 - kCosineShare) * (sum > 0 ? importance[bin] / sum : 1.0 / kBins);
  };
  // Inverts the cumulative distribution, linear inside a bin of t, at equal steps.
  edge_.front() = 0;
  int bin = 0;
  double below = 0;
  for (int k = 1; k < kBins; ++k) {
    const double wanted = static_cast<double>(k) / kBins;
    while (below + probability(bin) < wanted) below += probability(bin++);
    edge_[k] = (bin + (wanted - below) / probability(bin)) / kBins;
  }
  edge_.back() = 1;
}

double Guide::density(double square) const {
  const auto above = std::upper_bound(edge_.begin() + 1, edge_.end() - 1, square);
  return 1 / (kBins * (*above - *(above - 1)));
}

}  // namespace sunbeam::walk
