#include "rest_sampler.h"

namespace sunbeam {

double RestSampler::cosine_of_row(int row) {
  constexpr double kSmallestCosine = 1e-4;
  const double root = static_cast<double>(row) / (kRows - 1);
  return std::max(root * root, kSmallestCosine);
}

void RestSampler::add_row(std::span<const double> density, double first_chance) {
  double total = 0;
  for (const double d : density) total += d;
  Row row;
  double sum = 0;
  row.cdf[0] = 0;
  for (std::size_t k = 0; k < kBins; ++k) {
    sum += total > 0 ? density[k] / total : 1.0 / kBins;
    row.cdf[k + 1] = k + 1 < kBins ? static_cast<float>(sum) : 1;
    row.density[k] = (row.cdf[k + 1] - row.cdf[k]) * kBins;  // of what is sampled, to the last bit
  }
  for (std::size_t k = 0, bin = 0; k < kBins; ++k) {
    while (row.cdf[bin + 1] <= static_cast<float>(k) / kBins) ++bin;
    row.guide[k] = static_cast<std::uint8_t>(bin);
  }
  chance_[rows_.size()] = static_cast<float>(first_chance);
  rows_.push_back(row);
}

double RestSampler::sample(const EvenPosition& viewer, double u) const {
  // One number for both: which row, and where in it.
  const bool upper = u < viewer.upper_weight;
  const double within =
      upper ? u / viewer.upper_weight : (u - viewer.upper_weight) / (1 - viewer.upper_weight);
  constexpr double kBelowOne = 1 - 0x1p-24;
  const double v = std::min(within, kBelowOne);
  const Row& row = rows_[static_cast<std::size_t>(viewer.lower + (upper ? 1 : 0))];
  std::size_t bin = row.guide[static_cast<std::size_t>(v * kBins)];
  while (row.cdf[bin + 1] <= v) ++bin;
  const double position = (v - row.cdf[bin]) / (row.cdf[bin + 1] - row.cdf[bin]);
  return (static_cast<double>(bin) + std::clamp(position, 0x1p-24, kBelowOne)) / kBins;
}

}  // namespace sunbeam
