#include "bake/dense/table_around.h"

#include <algorithm>

namespace sunbeam {
namespace {

struct Span {
  std::size_t first, count;
};

// The nodes that a value at x is made of, and their neighbours up to four, so that the part's own stencil is
// the same.
Span nodes_around(const Axis& axis, double x) {
  const std::size_t count = std::min<std::size_t>(4, axis.size());
  const std::size_t lower = axis.locate(x).lower;
  return {std::min(lower > 0 ? lower - 1 : 0, axis.size() - count), count};
}

}  // namespace

Table table_around(const Table& outline, const DenseCells& cells, const Parameters& parameters) {
  Table part = outline;
  std::vector<Axis> axes = outline.remainder.axes();
  std::array<Span, 3> at{};
  for (std::size_t k = 0; k < at.size(); ++k) {
    at[k] = nodes_around(axes[k], parameters.values()[k]);
    const auto first = axes[k].nodes.begin() + static_cast<std::ptrdiff_t>(at[k].first);
    axes[k].nodes = {first, first + static_cast<std::ptrdiff_t>(at[k].count)};
  }
  part.remainder = NdArray("remainder", axes, outline.remainder.precision());
  part.rest_stderr = NdArray("rest_stderr", axes, outline.rest_stderr.precision(), 1);
  auto to_remainder = part.remainder.values().begin();
  auto to_stderr = part.rest_stderr.values().begin();
  const auto& whole = outline.remainder;
  for (std::size_t a = 0; a < at[0].count; ++a)
    for (std::size_t b = 0; b < at[1].count; ++b) {
      const std::size_t cell = (at[0].first + a) * whole.stride(0) + (at[1].first + b) * whole.stride(1);
      const std::size_t node = cell / whole.stride(2) + at[2].first;
      to_remainder = std::ranges::copy(cells.remainder(node, at[2].count), to_remainder).out;
      to_stderr = std::ranges::copy(cells.rest_stderr(node, at[2].count), to_stderr).out;
    }
  return part;
}

}  // namespace sunbeam
