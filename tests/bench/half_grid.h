// Colours in half floats over three coordinates in [0, 1], evenly spaced nodes, trilinear between: the
// plainest table there is. Conversions are F16C where the processor has it, else Imath's.
#pragma once

#include <Imath/half.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {

class HalfGrid {
 public:
  using Nodes = std::array<std::size_t, 3>;

  explicit HalfGrid(const Nodes& nodes)
      : nodes_(nodes),
        strides_{3 * nodes[1] * nodes[2], 3 * nodes[2], 3},
        values_(strides_[0] * nodes[0] + 1) {}

  static bool has_f16c() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("f16c");
#else
    return false;
#endif
  }

  const Nodes& nodes() const { return nodes_; }
  std::size_t bytes() const { return (values_.size() - 1) * sizeof(std::uint16_t); }

  // Finite: what is beyond the largest half becomes that.
  void set(const Nodes& at, const Rgb& value) {
    for (int c = 0; c < 3; ++c)
      values_[offset(at) + static_cast<std::size_t>(c)] =
          Imath::half(static_cast<float>(std::clamp<double>(value[c], -HALF_MAX, HALF_MAX))).bits();
  }

  Rgb operator()(double x, double y, double z) const {
#if defined(__x86_64__)
    if (f16c_) return interpolate_f16c({x, y, z});
#endif
    return interpolate({x, y, z});
  }

 private:
  struct Corner {
    const std::uint16_t* lowest;
    std::array<float, 3> upper_weight;
  };

  std::size_t offset(const Nodes& at) const {
    return at[0] * strides_[0] + at[1] * strides_[1] + at[2] * strides_[2];
  }

  // Signed 32-bit indices: other conversions from floating point and back branch.
  Corner locate(const std::array<double, 3>& x) const {
    Corner corner{values_.data(), {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto last = static_cast<std::int32_t>(nodes_[k]) - 1;
      const auto scaled = static_cast<float>(x[k]) * static_cast<float>(last);
      const auto lower = std::min(static_cast<std::int32_t>(scaled), last - 1);
      corner.lowest += static_cast<std::size_t>(lower) * strides_[k];
      corner.upper_weight[k] = scaled - static_cast<float>(lower);
    }
    return corner;
  }

  Rgb interpolate(const std::array<double, 3>& x) const {
    const Corner corner = locate(x);
    Rgb sum;
    for (unsigned upper = 0; upper < 8; ++upper) {
      const std::uint16_t* cell = corner.lowest;
      float weight = 1;
      for (unsigned k = 0; k < 3; ++k) {
        const bool is_upper = (upper >> k) & 1;
        cell += is_upper ? strides_[k] : 0;
        weight *= is_upper ? corner.upper_weight[k] : 1 - corner.upper_weight[k];
      }
      sum += weight * Rgb(value_of(cell[0]), value_of(cell[1]), value_of(cell[2]));
    }
    return sum;
  }

  static float value_of(std::uint16_t bits) {
    Imath::half value;
    value.setBits(bits);
    return value;
  }

#if defined(__x86_64__)
  __attribute__((target("f16c"))) static __m128 colour(const std::uint16_t* cell) {
    return _mm_cvtph_ps(_mm_loadu_si64(cell));
  }
  __attribute__((target("f16c"))) static __m128 between(float t, __m128 a, __m128 b) {
    return _mm_add_ps(a, _mm_mul_ps(_mm_set1_ps(t), _mm_sub_ps(b, a)));
  }
  __attribute__((target("f16c"))) __m128 edge(const std::uint16_t* cell, float t) const {
    return between(t, colour(cell), colour(cell + strides_[2]));
  }
  __attribute__((target("f16c"))) __m128 face(const std::uint16_t* cell, const Corner& corner) const {
    return between(corner.upper_weight[1], edge(cell, corner.upper_weight[2]),
                   edge(cell + strides_[1], corner.upper_weight[2]));
  }
  __attribute__((target("f16c"))) Rgb interpolate_f16c(const std::array<double, 3>& x) const {
    const Corner corner = locate(x);
    alignas(16) float value[4];
    _mm_store_ps(value, between(corner.upper_weight[0], face(corner.lowest, corner),
                                face(corner.lowest + strides_[0], corner)));
    return {value[0], value[1], value[2]};
  }
#endif

  Nodes nodes_, strides_;
  std::vector<std::uint16_t> values_;  // one more than there are: colours are read four values at a time
  bool f16c_ = has_f16c();
};

}  // namespace sunbeam
