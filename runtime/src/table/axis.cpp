#include "sunbeam/detail/axis.h"

#include <algorithm>
#include <cmath>

namespace sunbeam {
inline namespace v1 {

double Axis::coordinate(double x) const {
  const double y = x - origin;
  if (power == 1) return y;
  if (softness > 0) return y / std::sqrt(std::abs(y) + softness);
  const double distance = std::abs(y);
  const double root = power == 2   ? std::sqrt(distance)
                      : power == 3 ? std::cbrt(distance)
                                   : std::pow(distance, 1 / power);
  return std::copysign(root, y);
}

double Axis::at_coordinate(double u) const {
  if (power == 1) return origin + u;
  const double distance = softness > 0 ? std::abs(u) * (std::abs(u) + std::sqrt(u * u + 4 * softness)) / 2
                                       : std::pow(std::abs(u), power);
  return origin + std::copysign(distance, u);
}

Axis::Run Axis::smooth_run(std::size_t lower) const {
  const bool has_kink = power != 1 && softness == 0 && low() < origin && origin < nodes.back();
  if (!has_kink) return {0, size()};
  const auto at = std::lower_bound(nodes.begin(), nodes.end(), origin);
  const auto kink = static_cast<std::size_t>(at - nodes.begin());
  return lower < kink ? Run{0, kink + 1} : Run{kink, size() - kink};
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
  const Run run = smooth_run(at.lower);
  result.count = std::min<std::size_t>(4, run.count);
  const std::size_t first = std::clamp(at.lower, run.first + 1, run.first + run.count - result.count + 1) - 1;
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

namespace {

// Differences of coordinates are divided by, also in floats.
bool has_coinciding_nodes(const Axis& axis) {
  constexpr double kLeastShare = 1e-6, kLeastRelative = 1e-12;
  const double first = axis.coordinate(axis.low()), last = axis.coordinate(axis.high());
  const double least =
      std::max(kLeastShare * (last - first), kLeastRelative * std::max(std::abs(first), std::abs(last)));
  double before = first;
  for (std::size_t i = 1; i < axis.size(); ++i) {
    const double here = axis.coordinate(axis.nodes[i]);
    if (!(here - before >= least) || !std::isfinite(here)) return true;
    before = here;
  }
  return axis.period > 0 && axis.size() > 1 && !(last - before >= least);
}

}  // namespace

std::string Axis::defect() const {
  if (nodes.empty()) return "has no nodes";
  if (!(power >= 1 && power <= 8)) return "has a power outside 1 to 8";
  if (!(period >= 0) || !std::isfinite(period)) return "has a bad period";
  if (!std::isfinite(origin)) return "has an origin that is not finite";
  constexpr double kLeastSoftness = 1e-6, kMostSoftness = 1;
  const bool is_softened = softness >= kLeastSoftness && softness <= kMostSoftness && power == 2;
  if (softness != 0 && !is_softened) return "has a bad softness";
  if (period > 0 && is_cubic) return "is both periodic and cubic";
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!std::isfinite(nodes[i])) return "has a node that is not finite";
    if (i > 0 && !(nodes[i] > nodes[i - 1])) return "has nodes that do not increase";
  }
  if (period > 0 && nodes.back() >= nodes.front() + period) return "has nodes beyond its period";
  const bool has_kink = power != 1 && softness == 0 && nodes.front() < origin && origin < nodes.back();
  if (has_kink && !std::binary_search(nodes.begin(), nodes.end(), origin))
    return "has its origin between two nodes";
  if (has_coinciding_nodes(*this)) return "has nodes whose coordinates coincide";
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

std::size_t intervals_below(std::size_t intervals, double below, double above) {
  // What is below needs more than its share: quantities bend twice there, at the kink and where it moves to.
  const double share = static_cast<double>(intervals) * below / (below + above);
  const auto least = intervals * 9 / 20;
  return std::clamp<std::size_t>(std::max(static_cast<std::size_t>(std::lround(share)), least), 1,
                                 intervals - 1);
}

std::vector<double> spaced_nodes(const Axis& axis, double from, double to, std::size_t count) {
  if (axis.softness == 0 && from >= axis.origin)
    return spaced_nodes(from, to, count, axis.power, axis.origin);
  const double u0 = axis.coordinate(from), u1 = axis.coordinate(to);
  const std::size_t intervals = count - 1;
  const bool is_sharp = axis.power != 1 && axis.softness == 0;
  const std::size_t kink = is_sharp && u0 < 0 && u1 > 0 ? intervals_below(intervals, -u0, u1) : 0;
  std::vector<double> nodes(count, from);
  for (std::size_t i = 1; i < count; ++i) {
    const bool is_below = i < kink;
    const double begin = kink == 0 || is_below ? u0 : 0, end = is_below ? 0 : u1;
    const std::size_t first = is_below ? 0 : kink, last = is_below ? kink : intervals;
    nodes[i] = axis.at_coordinate(
        std::lerp(begin, end, static_cast<double>(i - first) / static_cast<double>(last - first)));
  }
  if (count > 1) nodes.back() = to;
  return nodes;
}

}  // namespace v1
}  // namespace sunbeam
