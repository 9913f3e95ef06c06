#include "runtime/tracer/environment.h"

namespace sunbeam {
namespace {

// Map coordinates in [0, 1]: x from the left, y from the top.
Point2 map_from_direction(const Vec3& w) {
  return {0.5 - std::atan2(w.y, w.x) / (2 * kPi), std::acos(std::clamp(w.z, -1.0, 1.0)) * kInvPi};
}

Vec3 direction_from_map(const Point2& p) { return spherical_direction(kPi * p.y, kPi * (1 - 2 * p.x)); }

int texel(double coordinate, int size) {
  return std::clamp(static_cast<int>(coordinate * size), 0, size - 1);
}

}  // namespace

Environment::Environment(const EnvironmentSource& source) : source_(source) {
  const Image& map = source.map;
  std::vector<double> row_weights, weights(static_cast<std::size_t>(map.width));
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) weights[static_cast<std::size_t>(x)] = mean(map.get(x, y));
    columns_.emplace_back(weights);
    row_weights.push_back(columns_.back().integral() * std::sin(kPi * (y + 0.5) / map.height));
  }
  if (can_sample()) rows_ = PiecewiseConstant(row_weights);
}

Rgb Environment::radiance(const Vec3& wi) const {
  if (source_.map.empty()) return source_.color;
  const Point2 p = map_from_direction(wi);
  return source_.map.get(texel(p.x, source_.map.width), texel(p.y, source_.map.height));
}

Vec3 Environment::sample(const Point2& u) const {
  const double y = rows_.sample(u.y);
  const auto row = static_cast<std::size_t>(texel(y, source_.map.height));
  return direction_from_map({columns_[row].sample(u.x), y});
}

double Environment::pdf(const Vec3& wi) const {
  if (!can_sample()) return 0;
  const double sin_theta = std::sqrt(wi.x * wi.x + wi.y * wi.y);
  if (sin_theta <= 0) return 0;  // the poles are single points
  const Point2 p = map_from_direction(wi);
  const auto row = static_cast<std::size_t>(texel(p.y, source_.map.height));
  // The unit square covers angles 2 pi by pi, and solid angle is sin(theta) dtheta dphi.
  return rows_.pdf(p.y) * columns_[row].pdf(p.x) / (2 * kPi * kPi * sin_theta);
}

}  // namespace sunbeam
