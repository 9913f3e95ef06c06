#include "runtime/tracer/light_choice.h"

#include <numeric>

namespace sunbeam {
namespace {

constexpr double kEvenPart = 0.1;
constexpr double kPointSoftening = 1e-200;  // next to nothing, but a weight stays finite

}  // namespace

LightChoice::LightChoice(const Scene& scene, const Environment& environment) {
  const auto add = [&](const Vec3& position, const Vec3& normal, const Rgb& radiance, double area) {
    near_.push_back({position, normal, mean(radiance) * area, area * kInvPi});
  };
  for (const QuadLight& light : scene.quad_lights) {
    const Vec3 area_normal = cross(light.edge_u, light.edge_v);
    add(light.corner + 0.5 * (light.edge_u + light.edge_v), area_normal, light.radiance, length(area_normal));
  }
  for (const SphereLight& light : scene.sphere_lights)
    add(light.center, {}, light.radiance, kPi * square(light.radius));
  for (const PointLight& light : scene.point_lights)
    near_.push_back({light.position, {}, mean(light.intensity), kPointSoftening});
  for (const DirectionalLight& light : scene.directional_lights) far_off_.push_back(mean(light.irradiance));
  if (environment.can_sample()) far_off_.push_back(kPi * environment.mean_radiance());
  far_off_weight_ = std::accumulate(far_off_.begin(), far_off_.end(), 0.0);
  size_ = near_.size() + far_off_.size();
}

inline double LightChoice::near_weight(const Near& source, const Vec3& from) {
  const Vec3 away = from - source.position;
  return dot(away, source.normal) < 0 ? 0 : source.power / (dot(away, away) + source.softening);
}

inline double LightChoice::weight(std::size_t source, const Vec3& from) const {
  return source < near_.size() ? near_weight(near_[source], from) : far_off_[source - near_.size()];
}

LightChoice::Shares LightChoice::shares(const Vec3& from) const {
  double total = far_off_weight_;
  for (const Near& source : near_) total += near_weight(source, from);
  const double even = 1 / static_cast<double>(size_);
  return total > 0 ? Shares{kEvenPart * even, (1 - kEvenPart) / total} : Shares{even, 0};
}

LightChoice::Choice LightChoice::choose_among_several(const Vec3& from, double u) const {
  const Shares shares_here = shares(from);
  for (std::size_t source = 0;; ++source) {
    const double chance = shares_here.of(weight(source, from));
    if (u < chance || source + 1 == size_) return {source, chance};
    u -= chance;
  }
}

double LightChoice::chance_among_several(std::size_t source, const Vec3& from) const {
  return shares(from).of(weight(source, from));
}

}  // namespace sunbeam
