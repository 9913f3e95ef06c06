#include "runtime/src/textured/resolved_axis.h"

namespace sunbeam {
inline namespace v1 {
namespace {

Sampled interpolated(const Axis& axis, const std::vector<Sampled>& nodes, double x) {
  const Stencil at = axis.stencil(x);
  Sampled sum(nodes.front().size());
  for (std::size_t k = 0; k < at.count; ++k)
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += at.weight[k] * nodes[at.node[k]][j];
  return sum;
}

double between(const Axis& axis, std::size_t lower) {
  return axis.at_coordinate((axis.coordinate(axis.nodes[lower]) + axis.coordinate(axis.nodes[lower + 1])) /
                            2);
}

// Puts one of `middles` between each two of `nodes`.
template <class T>
std::vector<T> interleaved(const std::vector<T>& nodes, const std::vector<T>& middles) {
  std::vector<T> result;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    result.push_back(nodes[k]);
    if (k < middles.size()) result.push_back(middles[k]);
  }
  return result;
}

}  // namespace

Axis resolved_axis(Axis axis, int first, int most, double most_error,
                   const std::function<Sampled(double)>& sample,
                   const std::function<double(const Sampled&, const Sampled&)>& error) {
  const double low = axis.low(), high = axis.high();
  if (axis.size() == 1) return axis;
  axis.nodes = spaced_nodes(axis, low, high, static_cast<std::size_t>(std::min(first, most)) + 1);
  std::vector<Sampled> values;
  for (const double x : axis.nodes) values.push_back(sample(x));
  while (2 * (axis.size() - 1) <= static_cast<std::size_t>(most)) {
    std::vector<double> middles;
    std::vector<Sampled> expected;
    double found = 0;
    for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
      middles.push_back(between(axis, k));
      expected.push_back(sample(middles.back()));
      found = std::max(found, error(expected.back(), interpolated(axis, values, middles.back())));
    }
    if (found <= most_error) break;
    axis.nodes = interleaved(axis.nodes, middles);
    values = interleaved(values, expected);
  }
  return axis;
}

}  // namespace v1
}  // namespace sunbeam
