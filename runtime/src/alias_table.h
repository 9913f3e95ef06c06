// A discrete distribution drawn in constant time without a search: Walker's alias method, tables by Vose
// 1991.
#pragma once

#include <array>
#include <cmath>
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

  // Relative to an even one; what the rounded thresholds amount to.
  std::array<double, kBins> densities() const {
    std::array<double, kBins> drawn{};
    for (std::size_t k = 0; k < kBins; ++k) {
      const double stays = bins_[k].threshold / kWhole;
      drawn[k] += stays;
      drawn[bins_[k].alias] += 1 - stays;
    }
    return drawn;
  }

  // Bits in place of a choice, which a processor would guess wrong.
  std::size_t draw(std::uint32_t random) const {
    const std::uint64_t scaled = std::uint64_t{random} * kBins;
    const auto bin = static_cast<std::uint32_t>(scaled >> 32);
    const auto [threshold, alias] = bins_[bin];
    const std::uint32_t stays = (static_cast<std::uint32_t>(scaled) >> 8) < threshold;
    return alias ^ ((alias ^ bin) & (0 - stays));
  }

 private:
  void set(std::size_t bin, double threshold, std::size_t alias) {
    bins_[bin] = {static_cast<std::uint32_t>(std::lround(threshold * kWhole)),
                  static_cast<std::uint32_t>(alias)};
  }

  static constexpr double kWhole = 1 << 24;
  struct Bin {
    std::uint32_t threshold = 0;  // chance that the bin stands for itself, of kWhole,
    std::uint32_t alias = 0;      // else for this one
  };
  std::array<Bin, kBins> bins_;
};

}  // namespace sunbeam
