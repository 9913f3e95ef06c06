#include "runtime/tracer/lights.h"

#include <limits>

#include "sunbeam/core/frame.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {
namespace {

constexpr double kFarOff = std::numeric_limits<double>::infinity();

// 1 - cos(x) without cancellation, from sin^2(x).
double one_minus_cosine(double sine2) { return sine2 / (1 + std::sqrt(1 - sine2)); }

// Uniform over the directions within a cone about `axis`; `height` is 1 - cos of its half angle.
Vec3 sample_cone(const Vec3& axis, double height, const Point2& u) {
  const double down = height * u.x;
  const double sine = std::sqrt(down * (2 - down));
  const Turn turn(u.y);
  return Frame::from_normal(axis).to_world({sine * turn.cosine, sine * turn.sine, 1 - down});
}

double cone_pdf(double height) { return 1 / (2 * kPi * height); }

// Below, `chance` is that of choosing the light.

inline Emission quad(const QuadLight& light, const Vec3& direction, double distance, double chance) {
  const Vec3 area_normal = cross(light.edge_u, light.edge_v);  // its length is the area
  const double projected_area = -dot(direction, area_normal);
  if (projected_area <= 0) return {Rgb(), 0};
  return {light.radiance, chance * square(distance) / projected_area};
}

// Of any direction from `from` that meets the sphere.
Emission sphere(const SphereLight& light, const Vec3& from, double chance) {
  const Vec3 to_center = light.center - from;
  const double sine2 = square(light.radius) / dot(to_center, to_center);
  if (!(sine2 < 1)) return {Rgb(), 0};  // inside
  return {light.radiance, chance * cone_pdf(one_minus_cosine(sine2))};
}

std::optional<LightSample> sample_quad(const QuadLight& light, const Vec3& from, double chance,
                                       const Point2& u) {
  const Vec3 to_light = light.corner + u.x * light.edge_u + u.y * light.edge_v - from;
  const double distance = length(to_light);
  if (distance <= 0) return {};
  const Vec3 wi = to_light / distance;
  const Emission emission = quad(light, wi, distance, chance);
  if (emission.pdf <= 0) return {};
  return LightSample{wi, distance, emission.radiance, emission.pdf, false};
}

// Uniform over the solid angle of the sphere.
std::optional<LightSample> sample_sphere(const SphereLight& light, const Vec3& from, double chance,
                                         const Point2& u) {
  const Emission emission = sphere(light, from, chance);
  if (emission.pdf <= 0) return {};
  const Vec3 to_center = light.center - from;
  const double sine2 = square(light.radius) / dot(to_center, to_center);
  const Vec3 wi = sample_cone(normalize(to_center), one_minus_cosine(sine2), u);
  const double along = dot(to_center, wi);
  const double chord2 = square(light.radius) - (dot(to_center, to_center) - square(along));
  return LightSample{wi, along - std::sqrt(std::max(0.0, chord2)), emission.radiance, emission.pdf, false};
}

std::optional<LightSample> sample_point(const PointLight& light, const Vec3& from, double chance) {
  const Vec3 to_light = light.position - from;
  const double distance = length(to_light);
  if (distance <= 0) return {};
  return LightSample{to_light / distance, distance, light.intensity / square(distance), chance, true};
}

}  // namespace

Lights::Lights(const Scene& scene)
    : scene_(scene), environment_(scene.environment), choice_(scene, environment_) {
  for (const DirectionalLight& light : scene.directional_lights) {
    const double radius = light.angle_deg * (kPi / 360);
    if (radius <= 0) {
      discs_.push_back({light.towards, 2, light.irradiance, 0});
      continue;
    }
    const double sine2 = square(std::sin(radius));  // pi sine2 is the disc's solid angle, cosine included
    discs_.push_back({light.towards, std::cos(radius), light.irradiance / (kPi * sine2),
                      cone_pdf(one_minus_cosine(sine2))});
  }
}

Emission Lights::environment(const Vec3& from, const Vec3& direction) const {
  const Rgb radiance = environment_.radiance(direction);
  if (!environment_.can_sample()) return {radiance, 0};
  return {radiance, choice_.chance(choice_.size() - 1, from) * environment_.pdf(direction)};
}

std::optional<LightSample> Lights::sample(const Vec3& from, const Random3& u) const {
  if (choice_.size() == 0) return {};
  const LightChoice::Choice choice = choice_.choose(from, u[0]);
  const double chance = choice.chance;
  const Point2 point = {u[1], u[2]};
  std::size_t chosen = choice.source;
  // Whether the choice fell into the next `size` sources; else it counts from behind them.
  const auto is_among = [&](std::size_t size) {
    if (chosen < size) return true;
    chosen -= size;
    return false;
  };
  if (is_among(scene_.quad_lights.size()))
    return sample_quad(scene_.quad_lights[chosen], from, chance, point);
  if (is_among(scene_.sphere_lights.size()))
    return sample_sphere(scene_.sphere_lights[chosen], from, chance, point);
  if (is_among(scene_.point_lights.size())) return sample_point(scene_.point_lights[chosen], from, chance);
  if (is_among(discs_.size())) return sample_directional(chosen, chance, point);
  return sample_environment(chance, point);
}

std::optional<LightSample> Lights::sample_directional(std::size_t light, double chance,
                                                      const Point2& u) const {
  const Disc& disc = discs_[light];
  if (disc.pdf == 0) return LightSample{disc.towards, kFarOff, disc.radiance, chance, true};
  const double radius = scene_.directional_lights[light].angle_deg * (kPi / 360);
  const Vec3 wi = sample_cone(disc.towards, one_minus_cosine(square(std::sin(radius))), u);
  return LightSample{wi, kFarOff, disc.radiance, chance * disc.pdf, false};
}

std::optional<LightSample> Lights::sample_environment(double chance, const Point2& u) const {
  const Vec3 wi = environment_.sample(u);
  const double density = chance * environment_.pdf(wi);
  if (density <= 0) return {};
  return LightSample{wi, kFarOff, environment_.radiance(wi), density, false};
}

Emission Lights::surface(int light, const Vec3& from, const Vec3& direction, double distance) const {
  const auto i = static_cast<std::size_t>(light);
  const std::size_t quads = scene_.quad_lights.size();
  const double chance = choice_.chance(i, from);
  return i < quads ? quad(scene_.quad_lights[i], direction, distance, chance)
                   : sphere(scene_.sphere_lights[i - quads], from, chance);
}

}  // namespace sunbeam
