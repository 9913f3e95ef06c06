// How fast paths could be traced at best: bare Embree, single precision, one grey albedo and one quad light,
// with the rays that the path tracer casts: to the next hit, to the light from every hit that faces it,
// cosine-distributed bounces, and Russian roulette after the same number of them. Shading is flat, light is
// sampled and never met by chance. Nothing else is kept or computed.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <variant>

#include "runtime/tracer/embree_api.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {

class EmbreeCeiling {
 public:
  // Of a scene of meshes with a constant environment, one quad light and a pinhole camera.
  EmbreeCeiling(const Scene& scene, float albedo) : scene_(scene), albedo_(albedo) {
    if (scene.quad_lights.size() != 1) throw Error("the bare loop traces scenes with one quad light");
    const QuadLight& light = scene.quad_lights[0];
    corner_ = to_float(light.corner), edge_u_ = to_float(light.edge_u), edge_v_ = to_float(light.edge_v);
    light_normal_ = to_float(cross(light.edge_u, light.edge_v));
    light_radiance_ = static_cast<float>(light.radiance.r);
    attach(quad_mesh(light.corner, light.edge_u, light.edge_v));
    for (const SceneObject& object : scene.objects) attach(std::get<Mesh>(object.shape));
    rtcSetSceneFlags(embree_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(embree_);
  }
  ~EmbreeCeiling() {
    rtcReleaseScene(embree_);
    rtcReleaseDevice(device_);
  }
  EmbreeCeiling(const EmbreeCeiling&) = delete;
  EmbreeCeiling& operator=(const EmbreeCeiling&) = delete;

  struct Counts {
    double radiance = 0;
    std::uint64_t rays = 0;
  };

  // One path along `direction` from the camera; adds what it found.
  void trace(const Vec3& direction, Rng& rng, Counts& counts) const {
    std::array<float, 3> origin = to_float(scene_.camera.position), along = to_float(direction);
    float weight = 1;
    for (int bounce = 0;; ++bounce) {
      RTCRayHit query = to_embree(origin, along);
      intersect_one(embree_, query);
      ++counts.rays;
      if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        counts.radiance += weight * static_cast<float>(scene_.environment.color.r);
        return;
      }
      if (query.hit.geomID == 0 || bounce == scene_.render.max_bounces) return;
      for (std::size_t k = 0; k < 3; ++k) origin[k] += query.ray.tfar * along[k];
      const std::array<float, 3> normal = facing_normal(query.hit, along);
      counts.radiance += weight * light_from(origin, normal, rng, counts);
      along = cosine_direction(normal, uniform(rng), uniform(rng));
      weight *= albedo_;
      if (bounce < scene_.render.roulette_after) continue;
      if (uniform(rng) >= weight) return;
      weight = 1;
    }
  }

 private:
  static float uniform(Rng& rng) { return static_cast<float>(rng.next() >> 8) * 0x1p-24f; }
  static std::array<float, 3> to_float(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  static float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  static RTCRay ray(const std::array<float, 3>& origin, const std::array<float, 3>& along, float far) {
    RTCRay ray{};
    ray.org_x = origin[0], ray.org_y = origin[1], ray.org_z = origin[2];
    ray.dir_x = along[0], ray.dir_y = along[1], ray.dir_z = along[2];
    ray.tnear = 1e-4f, ray.tfar = far, ray.mask = ~0u;
    return ray;
  }
  static RTCRayHit to_embree(const std::array<float, 3>& origin, const std::array<float, 3>& along) {
    RTCRayHit query{ray(origin, along, std::numeric_limits<float>::infinity()), {}};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
  }

  static std::array<float, 3> facing_normal(const RTCHit& hit, const std::array<float, 3>& along) {
    std::array<float, 3> normal = {hit.Ng_x, hit.Ng_y, hit.Ng_z};
    float scale = 1 / std::sqrt(dot(normal, normal));
    if (dot(normal, along) > 0) scale = -scale;
    for (float& x : normal) x *= scale;
    return normal;
  }

  static std::array<float, 3> cosine_direction(const std::array<float, 3>& n, float u, float v) {
    const float radius = std::sqrt(u), phi = 2 * std::numbers::pi_v<float> * v;
    const float x = radius * std::cos(phi), y = radius * std::sin(phi), z = std::sqrt(1 - u);
    const float sign = std::copysign(1.0f, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    const std::array<float, 3> s = {1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]};
    const std::array<float, 3> t = {b, sign + n[1] * n[1] * a, -n[1]};
    return {x * s[0] + y * t[0] + z * n[0], x * s[1] + y * t[1] + z * n[1], x * s[2] + y * t[2] + z * n[2]};
  }

  float light_from(const std::array<float, 3>& from, const std::array<float, 3>& normal, Rng& rng,
                   Counts& counts) const {
    const float s = uniform(rng), t = uniform(rng);
    std::array<float, 3> to_light;
    for (std::size_t k = 0; k < 3; ++k) to_light[k] = corner_[k] + s * edge_u_[k] + t * edge_v_[k] - from[k];
    const float cosine = dot(normal, to_light), light_cosine = -dot(light_normal_, to_light);
    if (cosine <= 0 || light_cosine <= 0) return 0;
    RTCRay shadow = ray(from, to_light, 0.9999f);
    occluded_one(embree_, shadow);
    ++counts.rays;
    if (shadow.tfar < 0) return 0;
    const float distance2 = dot(to_light, to_light);
    return albedo_ * std::numbers::inv_pi_v<float> * light_radiance_ * cosine * light_cosine /
           (distance2 * distance2);
  }

  void attach(const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    for (const Vec3& position : mesh.positions)
      for (const float x : to_float(position)) *vertex++ = x;
    auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) *index++ = corner;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_, geometry);
    rtcReleaseGeometry(geometry);
  }

  const Scene& scene_;
  float albedo_;
  std::array<float, 3> corner_, edge_u_, edge_v_, light_normal_;  // as long as the light is large
  float light_radiance_;
  RTCDevice device_ = rtcNewDevice(nullptr);
  RTCScene embree_ = rtcNewScene(device_);
};

}  // namespace sunbeam
