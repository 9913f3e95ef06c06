#include "runtime/tracer/lights.h"

#include <limits>

namespace sunbeam {

Lights::Lights(const Scene& scene)
    : scene_(scene),
      environment_(scene.environment),
      count_(scene.quad_lights.size() + scene.point_lights.size() + (environment_.can_sample() ? 1 : 0)) {}

std::optional<LightSample> Lights::sample(const Vec3& from, Rng& rng) const {
  if (count_ == 0) return {};
  const auto chosen = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count_));
  const std::size_t quads = scene_.quad_lights.size(), points = scene_.point_lights.size();
  if (chosen < quads) return sample_quad(chosen, from, rng);
  if (chosen < quads + points) return sample_point(chosen - quads, from);
  return sample_environment(rng);
}

std::optional<LightSample> Lights::sample_quad(std::size_t light, const Vec3& from, Rng& rng) const {
  const QuadLight& quad_light = scene_.quad_lights[light];
  const double s = rng.uniform(), t = rng.uniform();
  const Vec3 to_light = quad_light.corner + s * quad_light.edge_u + t * quad_light.edge_v - from;
  const double distance = length(to_light);
  if (distance <= 0) return {};
  const Vec3 wi = to_light / distance;
  const Emission emission = quad(static_cast<int>(light), wi, distance);
  if (emission.pdf <= 0) return {};
  return LightSample{wi, distance, emission.radiance, emission.pdf, false};
}

std::optional<LightSample> Lights::sample_point(std::size_t light, const Vec3& from) const {
  const PointLight& point_light = scene_.point_lights[light];
  const Vec3 to_light = point_light.position - from;
  const double distance = length(to_light);
  if (distance <= 0) return {};
  return LightSample{to_light / distance, distance, point_light.intensity / square(distance),
                     1 / static_cast<double>(count_), true};
}

std::optional<LightSample> Lights::sample_environment(Rng& rng) const {
  const double u = rng.uniform(), v = rng.uniform();
  const Vec3 wi = environment_.sample({u, v});
  const Emission emission = environment(wi);
  if (emission.pdf <= 0) return {};
  return LightSample{wi, std::numeric_limits<double>::infinity(), emission.radiance, emission.pdf, false};
}

Emission Lights::environment(const Vec3& direction) const {
  const double density =
      environment_.can_sample() ? environment_.pdf(direction) / static_cast<double>(count_) : 0;
  return {environment_.radiance(direction), density};
}

Emission Lights::quad(int light, const Vec3& direction, double distance) const {
  const QuadLight& quad_light = scene_.quad_lights[static_cast<std::size_t>(light)];
  const Vec3 area_normal = cross(quad_light.edge_u, quad_light.edge_v);  // its length is the area
  const double projected_area = -dot(direction, area_normal);
  if (projected_area <= 0) return {Rgb(), 0};
  return {quad_light.radiance, square(distance) / (projected_area * static_cast<double>(count_))};
}

}  // namespace sunbeam
