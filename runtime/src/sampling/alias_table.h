// This file draws from a discrete distribution in constant time without a search: by Walker's alias method,
// with tables by Vose 1991.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sunbeam {
inline namespace v1 {

template <int kBins>
class AliasTable {
  static_assert(kBins <= 4096 && (kBins & (kBins - 1)) == 0, "bins are drawn by the highest bits");

 public:
  // Makes chances in proportion to `weights`, >= 0, to 2^-32 of the whole; they are even if all weights are
  // 0.
  explicit AliasTable(std::span<const double> weights) {
    double total = 0;
    for (const double w : weights) total += w;
    std::array<double, kBins> left;
    std::array<std::uint32_t, kBins> small, large;
    std::size_t small_count = 0, large_count = 0;
    for (std::uint32_t k = 0; k < kBins; ++k) {
      left[k] = total > 0 ? weights[k] / total * kBins : 1;
      (left[k] < 1 ? small[small_count++] : large[large_count++]) = k;
    }
    while (small_count > 0 && large_count > 0) {
      const std::uint32_t s = small[--small_count], l = large[large_count - 1];
      set(s, left[s], l);
      left[l] -= 1 - left[s];
      if (left[l] >= 1) continue;
      --large_count;
      small[small_count++] = l;
    }
    for (std::size_t k = 0; k < small_count; ++k) set(small[k], 1, small[k]);
    for (std::size_t k = 0; k < large_count; ++k) set(large[k], 1, large[k]);
  }

  // Holds a bin, and what is left in [0, 1) of the number that chose it.
  struct Drawn {
    std::uint32_t bin;
    float left;
  };
  // Draws a bin by u in [0, 1), by arithmetic in place of a choice, which a processor would guess wrong.
  Drawn draw(double u) const {
    const double scaled = u * kBins;
    const auto bin = static_cast<std::uint32_t>(scaled);
    const std::uint32_t packed = bins_[bin];
    const float inside = static_cast<float>(scaled - bin),
                stays = static_cast<float>(threshold(packed)) * (1.0f / kWhole);
    const std::uint32_t moves = inside < stays ? 0 : 1;
    const float moved = static_cast<float>(moves);
    const float left = (inside - moved * stays) / (stays + moved * (1 - 2 * stays));
    return {bin ^ ((alias(packed) ^ bin) & (0 - moves)), std::min(left, 0x1.fffffep-1f)};
  }

 private:
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
