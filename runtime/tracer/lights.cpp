#include "runtime/tracer/lights.h"

#include <limits>

#include "sunbeam/core/frame.h"
#include "sunbeam/core/warp.h"

namespace sunbeam {
namespace {

constexpr double kFarOff = std::numeric_limits<double>::infinity();

// 1 - cos(x) without cancellation, from sin^2(x).
double one_minus_cosine(double sine2) { return sine2 / (1 + std::sqrt(1 - sine2)); }

// Uniform over the directions within a cone about `axis`; `height` is 1 - cos of its half angle.
Vec3 sample_cone(const Vec3& axis, double height, Rng& rng) {
  const double down = height * rng.uniform();
  const double sine = std::sqrt(down * (2 - down));
  const Turn turn(rng.uniform());
  return Frame::from_normal(axis).to_world({sine * turn.cosine, sine * turn.sine, 1 - down});
}

double cone_pdf(double height) { return 1 / (2 * kPi * height); }

}  // namespace

Lights::Lights(const Scene& scene) : scene_(scene), environment_(scene.environment) {
  count_ =
      static_cast<double>(scene.quad_lights.size() + scene.sphere_lights.size() + scene.point_lights.size() +
                          scene.directional_lights.size() + (environment_.can_sample() ? 1 : 0));
  for (const DirectionalLight& light : scene.directional_lights) {
    const double radius = light.angle_deg * (kPi / 360);
    if (radius <= 0) {
      discs_.push_back({light.towards, 2, light.irradiance, 0});
      continue;
    }
    const double sine2 = square(std::sin(radius));  // pi sine2 is the disc's solid angle, cosine included
    discs_.push_back({light.towards, std::cos(radius), light.irradiance / (kPi * sine2),
                      cone_pdf(one_minus_cosine(sine2)) / count_});
  }
}

Emission Lights::environment(const Vec3& direction) const {
  const double density = environment_.can_sample() ? environment_.pdf(direction) / count_ : 0;
  return {environment_.radiance(direction), density};
}

inline Emission Lights::quad(const QuadLight& light, const Vec3& direction, double distance) const {
  const Vec3 area_normal = cross(light.edge_u, light.edge_v);  // its length is the area
  const double projected_area = -dot(direction, area_normal);
  if (projected_area <= 0) return {Rgb(), 0};
  return {light.radiance, square(distance) / (projected_area * count_)};
}

// Of any direction from `from` that meets the sphere.
Emission Lights::sphere(const SphereLight& light, const Vec3& from) const {
  const Vec3 to_center = light.center - from;
  const double sine2 = square(light.radius) / dot(to_center, to_center);
  if (!(sine2 < 1)) return {Rgb(), 0};  // inside
  return {light.radiance, cone_pdf(one_minus_cosine(sine2)) / count_};
}

std::optional<LightSample> Lights::sample(const Vec3& from, Rng& rng) const {
  if (count_ == 0) return {};
  auto chosen = static_cast<std::size_t>(rng.uniform() * count_);
  // Whether the choice fell into the next `size` sources; else it counts from behind them.
  const auto is_among = [&](std::size_t size) {
    if (chosen < size) return true;
    chosen -= size;
    return false;
  };
  if (is_among(scene_.quad_lights.size())) return sample_quad(scene_.quad_lights[chosen], from, rng);
  if (is_among(scene_.sphere_lights.size())) return sample_sphere(scene_.sphere_lights[chosen], from, rng);
  if (is_among(scene_.point_lights.size())) return sample_point(scene_.point_lights[chosen], from);
  if (is_among(discs_.size())) return sample_directional(chosen, rng);
  return sample_environment(rng);
}

std::optional<LightSample> Lights::sample_quad(const QuadLight& light, const Vec3& from, Rng& rng) const {
  const double s = rng.uniform(), t = rng.uniform();
  const Vec3 to_light = light.corner + s * light.edge_u + t * light.edge_v - from;
  const double distance = length(to_light);
  if (distance <= 0) return {};
  const Vec3 wi = to_light / distance;
  const Emission emission = quad(light, wi, distance);
  if (emission.pdf <= 0) return {};
  return LightSample{wi, distance, emission.radiance, emission.pdf, false};
}

// Uniform over the solid angle of the sphere.
std::optional<LightSample> Lights::sample_sphere(const SphereLight& light, const Vec3& from, Rng& rng) const {
  const Emission emission = sphere(light, from);
  if (emission.pdf <= 0) return {};
  const Vec3 to_center = light.center - from;
  const double sine2 = square(light.radius) / dot(to_center, to_center);
  const Vec3 wi = sample_cone(normalize(to_center), one_minus_cosine(sine2), rng);
  const double along = dot(to_center, wi);
  const double chord2 = square(light.radius) - (dot(to_center, to_center) - square(along));
  return LightSample{wi, along - std::sqrt(std::max(0.0, chord2)), emission.radiance, emission.pdf, false};
}

std::optional<LightSample> Lights::sample_point(const PointLight& light, const Vec3& from) const {
  const Vec3 to_light = light.position - from;
  const double distance = length(to_light);
  if (distance <= 0) return {};
  return LightSample{to_light / distance, distance, light.intensity / square(distance), 1 / count_, true};
}

std::optional<LightSample> Lights::sample_directional(std::size_t light, Rng& rng) const {
  const Disc& disc = discs_[light];
  if (disc.pdf == 0) return LightSample{disc.towards, kFarOff, disc.radiance, 1 / count_, true};
  const double radius = scene_.directional_lights[light].angle_deg * (kPi / 360);
  const Vec3 wi = sample_cone(disc.towards, one_minus_cosine(square(std::sin(radius))), rng);
  return LightSample{wi, kFarOff, disc.radiance, disc.pdf, false};
}

std::optional<LightSample> Lights::sample_environment(Rng& rng) const {
  const double u = rng.uniform(), v = rng.uniform();
  const Vec3 wi = environment_.sample({u, v});
  const Emission emission = environment(wi);
  if (emission.pdf <= 0) return {};
  return LightSample{wi, kFarOff, emission.radiance, emission.pdf, false};
}

Emission Lights::surface(int light, const Vec3& from, const Vec3& direction, double distance) const {
  const auto i = static_cast<std::size_t>(light);
  const std::size_t quads = scene_.quad_lights.size();
  return i < quads ? quad(scene_.quad_lights[i], direction, distance)
                   : sphere(scene_.sphere_lights[i - quads], from);
}

}  // namespace sunbeam
