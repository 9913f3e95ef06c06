// This file keeps nodes of four lanes in 16 bits a lane, and blends them in integers: neighbours of two axes
// cost two loads and one conversion.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/src/base/color4.h"

namespace sunbeam {
inline namespace v1 {

// Holds the weights of two rows by two neighbours in each, in steps of 1 / kWhole. Their sum is kWhole to the
// last digit, so that what the neighbours share is kept.
struct PackedWeights {
  static constexpr int kWhole = 32767;

  // Takes the weights of the second row and of the second neighbour.
  PackedWeights(float row, float neighbour) {
    const auto in_steps = [](float x) { return static_cast<int>(x * kWhole + 0.5f); };
    const int of_row = in_steps(row), of_neighbour = in_steps(neighbour), both = in_steps(row * neighbour);
    first = packed(kWhole - of_row - of_neighbour + both, of_neighbour - both);
    second = packed(of_row - both, both);
  }
  // The weight of the neighbour is in the high bits.
  static int packed(int low, int high) {
    return static_cast<int>((static_cast<unsigned>(low) & 0xffff) | static_cast<unsigned>(high) << 16);
  }

  int first, second;  // of a row
};

class PackedNodes {
 public:
  PackedNodes() = default;
  // Spreads the steps of each lane evenly over what it holds.
  explicit PackedNodes(const std::vector<Color4>& nodes);

  // Blends the neighbours at and after `first` and `second`; value() gives what the sum stands for. It is
  // linear, so that sums may be blended first.
  Color4 blend(const PackedWeights& weights, std::size_t first, std::size_t second) const {
    return convert<Color4>(pair(&nodes_[first], weights.first) + pair(&nodes_[second], weights.second));
  }
  Color4 value(const Color4& sum) const { return middle_ + per_sum_ * sum; }

  // Returns the last lane of the neighbours at and after `first`, blended.
  float last_lane(std::size_t first, float upper_weight) const {
    const float low{static_cast<float>(nodes_[first][3])}, high{static_cast<float>(nodes_[first + 1][3])};
    return middle_[3] + per_sum_[3] * PackedWeights::kWhole * (low + upper_weight * (high - low));
  }

  const void* address(std::size_t node) const { return &nodes_[node]; }
  std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

 private:
  using Node = std::array<std::int16_t, 4>;
  static constexpr int kMost = 32767;  // of a lane, either way from the middle

#if defined(__SSE2__) && !defined(SUNBEAM_PORTABLE)
  static Ints4 pair(const Node* node, int weights) {
    const __m128i both = _mm_loadu_si128(reinterpret_cast<const __m128i*>(node));
    const __m128i lane_by_lane = _mm_unpacklo_epi16(both, _mm_unpackhi_epi64(both, both));
    return bits_as<Ints4>(_mm_madd_epi16(lane_by_lane, _mm_set1_epi32(weights)));
  }
#else
  static Ints4 pair(const Node* node, int weights) {
    const int low = static_cast<std::int16_t>(weights & 0xffff), high = weights >> 16;
    Ints4 sum;
    for (std::size_t k = 0; k < 4; ++k) sum[k] = low * node[0][k] + high * node[1][k];
    return sum;
  }
#endif

  std::vector<Node> nodes_;
  Color4 middle_{}, per_sum_{};  // of each lane
};

}  // namespace v1
}  // namespace sunbeam
