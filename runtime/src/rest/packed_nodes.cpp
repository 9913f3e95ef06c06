#include "runtime/src/rest/packed_nodes.h"

#include <algorithm>
#include <cmath>

namespace sunbeam {
inline namespace v1 {

PackedNodes::PackedNodes(const std::vector<Color4>& nodes) : nodes_(nodes.size()) {
  for (std::size_t lane = 0; lane < 4; ++lane) {
    const auto [least, most] = std::minmax_element(
        nodes.begin(), nodes.end(), [lane](const Color4& a, const Color4& b) { return a[lane] < b[lane]; });
    const double low{(*least)[lane]}, high{(*most)[lane]}, middle = (low + high) / 2;
    const double step = std::max((high - low) / (2 * kMost), 1e-9);
    middle_[lane] = static_cast<float>(middle);
    per_sum_[lane] = static_cast<float>(step / PackedWeights::kWhole);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      nodes_[k][lane] = static_cast<std::int16_t>(std::lround((double{nodes[k][lane]} - middle) / step));
  }
}

}  // namespace v1
}  // namespace sunbeam
