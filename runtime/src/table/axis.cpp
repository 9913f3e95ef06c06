#include "sunbeam/detail/axis.h"

#include <algorithm>
#include <cmath>

namespace sunbeam {
inline namespace v1 {

double Axis::coordinate(double x) const {
  if (power == 1) return x - origin;
  const double offset = std::max(0.0, x - origin);
  if (power == 2) return std::sqrt(offset);
  if (power == 3) return std::cbrt(offset);
  return std::pow(offset, 1 / power);
}

Bracket Axis::locate(double x) const {
  if (nodes.size() == 1) return {};
  if (period > 0) {
    x -= period * std::floor((x - nodes.front()) / period);
    if (x >= nodes.back()) {
      const double gap = nodes.front() + period - nodes.back();
      return {nodes.size() - 1, 0, std::min(1.0, (x - nodes.back()) / gap)};
    }
  }
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
  const auto upper = static_cast<std::size_t>(above - nodes.begin());
  const double u0 = coordinate(nodes[upper - 1]), u1 = coordinate(nodes[upper]);
  return {upper - 1, upper, std::clamp((coordinate(x) - u0) / (u1 - u0), 0.0, 1.0)};
}

Stencil Axis::stencil(double x) const {
  const Bracket at = locate(x);
  if (at.upper_weight == 0) return {1, {at.lower}, {1}};
  if (!is_cubic) return {2, {at.lower, at.upper}, {1 - at.upper_weight, at.upper_weight}};
  Stencil result;
  result.count = std::min<std::size_t>(4, size());
  const std::size_t first = std::min(at.lower > 0 ? at.lower - 1 : 0, size() - result.count);
  const double u = coordinate(std::clamp(x, low(), high()));
  for (std::size_t k = 0; k < result.count; ++k) {
    result.node[k] = first + k;
    result.weight[k] = 1;
    const double u_k = coordinate(nodes[first + k]);
    for (std::size_t j = 0; j < result.count; ++j)
      if (j != k) {
        const double u_j = coordinate(nodes[first + j]);
        result.weight[k] *= (u - u_j) / (u_k - u_j);
      }
  }
  return result;
}

std::string Axis::defect() const {
  if (nodes.empty()) return "has no nodes";
  if (!(power >= 1 && power <= 8)) return "has a power outside 1 to 8";
  if (!(period >= 0) || !std::isfinite(period)) return "has a bad period";
  if (!std::isfinite(origin) || (power != 1 && !(nodes.front() >= origin)))
    return "has a node below its origin";
  if (period > 0 && is_cubic) return "is both periodic and cubic";
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!std::isfinite(nodes[i])) return "has a node that is not finite";
    if (i > 0 && !(nodes[i] > nodes[i - 1])) return "has nodes that do not increase";
  }
  if (period > 0 && nodes.back() >= nodes.front() + period) return "has nodes beyond its period";
  return {};
}

std::vector<double> spaced_nodes(double from, double to, std::size_t count, double power, double origin) {
  std::vector<double> nodes(count, from);
  const double u0 = std::pow(from - origin, 1 / power), u1 = std::pow(to - origin, 1 / power);
  for (std::size_t i = 1; i < count; ++i)
    nodes[i] =
        origin + std::pow(std::lerp(u0, u1, static_cast<double>(i) / static_cast<double>(count - 1)), power);
  if (count > 1) nodes.back() = to;
  return nodes;
}

}  // namespace v1
}  // namespace sunbeam
