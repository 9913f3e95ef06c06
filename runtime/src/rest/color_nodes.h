// This file keeps colours at even nodes, three floats each. A look-up reads four, the last of which means
// nothing.
#pragma once

#include <cstring>
#include <vector>

#include "runtime/src/base/color4.h"

namespace sunbeam {
inline namespace v1 {

class ColorNodes {
 public:
  // All are black. A place beyond the last node, of weight 0, may be read.
  explicit ColorNodes(std::size_t nodes) : values_(3 * (nodes + 1) + 1) {}

  void set(std::size_t node, const Color4& color) {
    for (std::size_t c = 0; c < 3; ++c) values_[3 * node + c] = color[c];
  }
  Color4 get(std::size_t node) const {
    Color4 color;
    std::memcpy(&color, values_.data() + 3 * node, sizeof color);
    return color;
  }
  Color4 at(const EvenPosition& place) const {
    const auto lower = static_cast<std::size_t>(place.lower);
    const Color4 low = get(lower), high = get(lower + 1);
    return low + place.upper_weight * (high - low);
  }
  std::size_t size() const { return values_.size() / 3 - 1; }
  std::size_t bytes() const { return values_.size() * sizeof(float); }

 private:
  std::vector<float> values_;
};

}  // namespace v1
}  // namespace sunbeam
