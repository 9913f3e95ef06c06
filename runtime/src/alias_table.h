// A discrete distribution drawn in constant time without a search: Walker's alias method, tables by Vose
// 1991.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sunbeam {

template <int kBins>
class AliasTable {
  static_assert(kBins <= 65536 && (kBins & (kBins - 1)) == 0, "bins are drawn by the highest bits");

 public:
  // In proportion to `weights`, >= 0; even if they are all 0.
  explicit AliasTable(std::span<const double> weights) {
    double total = 0;
    for (const double w : weights) total += w;
    std::vector<double> left;
    std::vector<std::size_t> small, large;
    for (std::size_t k = 0; k < kBins; ++k) {
      left.push_back(total > 0 ? weights[k] / total * kBins : 1);
      (left[k] < 1 ? small : large).push_back(k);
    }
    std::array<double, kBins> drawn{};  // what the rounded thresholds amount to
    while (!small.empty() && !large.empty()) {
      const std::size_t s = small.back(), l = large.back();
      small.pop_back();
      set(s, left[s], l);
      left[l] -= 1 - left[s];
      if (left[l] >= 1) continue;
      large.pop_back();
      small.push_back(l);
    }
    for (const auto& rest : {small, large})
      for (const std::size_t k : rest) set(k, 1, k);
    for (std::size_t k = 0; k < kBins; ++k) {
      drawn[k] += threshold_[k];
      drawn[alias_[k]] += 1 - double{threshold_[k]};
    }
    for (std::size_t k = 0; k < kBins; ++k) density_[k] = static_cast<float>(drawn[k]);
  }

  // Relative to an even one.
  float density(std::size_t bin) const { return density_[bin]; }

  std::size_t draw(std::uint32_t random) const {
    const std::uint64_t scaled = std::uint64_t{random} * kBins;
    const std::size_t bin = scaled >> 32;
    return static_cast<float>(static_cast<std::uint32_t>(scaled) >> 8) * 0x1p-24f < threshold_[bin]
               ? bin
               : alias_[bin];
  }

 private:
  void set(std::size_t bin, double threshold, std::size_t alias) {
    threshold_[bin] = static_cast<float>(threshold);
    alias_[bin] = static_cast<std::uint16_t>(alias);
  }

  std::array<float, kBins> density_;
  std::array<float, kBins> threshold_{};
  std::array<std::uint16_t, kBins> alias_{};
};

}  // namespace sunbeam
