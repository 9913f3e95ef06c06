// This file draws from a discrete distribution in constant time without a search: by Walker's alias method,
// with tables by Vose 1991.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sunbeam {
inline namespace v1 {

template <int kBins>
class AliasTable {
  static_assert(kBins <= 4096 && (kBins & (kBins - 1)) == 0, "bins are drawn by the highest bits");

 public:
  // Makes chances in proportion to `weights`, >= 0; they are even if all weights are 0.
  explicit AliasTable(std::span<const double> weights) {
    double total = 0;
    for (const double w : weights) total += w;
    std::vector<double> left;
    std::vector<std::size_t> small, large;
    for (std::size_t k = 0; k < kBins; ++k) {
      left.push_back(total > 0 ? weights[k] / total * kBins : 1);
      (left[k] < 1 ? small : large).push_back(k);
    }
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
  }

  // Returns the densities relative to an even one; they are what the rounded thresholds amount to.
  std::array<double, kBins> densities() const {
    std::array<double, kBins> drawn{};
    for (std::uint32_t k = 0; k < kBins; ++k) {
      const double stays = threshold(bins_[k]) / double{kWhole};
      drawn[k] += stays;
      drawn[alias(bins_[k])] += 1 - stays;
    }
    return drawn;
  }

  // A bin, and what is left in [0, 1) of the number that chose it.
  struct Drawn {
    std::uint32_t bin;
    float left;
  };
  // Draws a bin by u in [0, 1).
  Drawn draw(double u) const {
    const double scaled = u * kBins;
    const auto bin = static_cast<std::uint32_t>(scaled);
    const double inside = scaled - bin, stays = threshold(bins_[bin]) / double{kWhole};
    if (inside < stays) return {bin, below_one(inside / stays)};
    return {alias(bins_[bin]), below_one((inside - stays) / (1 - stays))};
  }

 private:
  static float below_one(double x) { return std::min(static_cast<float>(x), 0x1.fffffep-1f); }

  // The chance that a bin stands for itself, of kWhole, is in the high bits, and the bin for which it stands
  // otherwise in the low ones. One that always stands for itself is its own alias.
  static constexpr std::uint32_t kWhole = (1ull << 32) / kBins;
  static std::uint32_t threshold(std::uint32_t packed) { return packed / kBins; }
  static std::uint32_t alias(std::uint32_t packed) { return packed % kBins; }

  void set(std::size_t bin, double threshold, std::size_t alias) {
    const long rounded = std::min(std::lround(threshold * kWhole), long{kWhole} - 1);
    bins_[bin] = static_cast<std::uint32_t>(rounded * kBins) + static_cast<std::uint32_t>(alias);
  }

  std::array<std::uint32_t, kBins> bins_{};  // a cache line holds sixteen
};

}  // namespace v1
}  // namespace sunbeam
