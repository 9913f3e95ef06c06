#include "runtime/tracer/embree_scene.h"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <vector>

#include "runtime/tracer/embree_api.h"
#include "runtime/tracer/huge_pages.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// About 32 roundings of a single-precision coordinate: more than building and tracing a triangle lose.
constexpr double kRelativeOffset = 4e-6;
constexpr double kShadowFraction = 1 - 1e-4;

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryRelease {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneRelease>;
using Geometry = std::unique_ptr<RTCGeometryTy, GeometryRelease>;

using Float3 = std::array<float, 3>;

// What every hit of a triangle reads, in one line of the cache: anywhere else it would wait twice for memory.
struct alignas(64) Triangle {
  Float3 corner, normal;          // the geometric one, unit
  std::array<Float3, 3> normals;  // of the vertices; of a flat mesh the geometric one
};

// Exactly one of `sphere` and `mesh` is set. Its place in the list is its geometry id.
struct Surface {
  const Sphere* sphere = nullptr;
  const Mesh* mesh = nullptr;
  int object = -1, light = -1;
  double offset = 0;
  std::vector<Float3> positions = {};  // of the vertices, which Embree reads
  std::vector<Triangle, HugePages<Triangle>> triangles = {};
  std::vector<Vec3> tangents = {};  // of the triangles of a flat mesh, of the vertices of a smooth one
  bool has_coordinates = false;
  std::vector<UvDerivatives> derivatives = {};  // of the vertices of a mesh with coordinates
};

Float3 to_float(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
Vec3 to_double(const Float3& v) { return {v[0], v[1], v[2]}; }

std::vector<Float3> positions_of(const Mesh& mesh) {
  std::vector<Float3> positions;
  positions.reserve(mesh.positions.size() + 1);
  for (const Vec3& position : mesh.positions) positions.push_back(to_float(position));
  positions.emplace_back();  // Embree may read 16 bytes at the last
  return positions;
}

std::vector<Triangle, HugePages<Triangle>> triangles_of(const Mesh& mesh,
                                                        const std::vector<Float3>& positions) {
  std::vector<Triangle, HugePages<Triangle>> triangles(mesh.triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [i, j, k] = mesh.triangles[t];
    const Vec3 a = to_double(positions[i]), b = to_double(positions[j]), c = to_double(positions[k]);
    const Float3 normal = to_float(normalize(cross(b - a, c - a)));
    triangles[t] = {positions[i], normal, {normal, normal, normal}};
    if (!mesh.normals.empty())
      triangles[t].normals = {to_float(mesh.normals[i]), to_float(mesh.normals[j]),
                              to_float(mesh.normals[k])};
  }
  return triangles;
}

double largest_coordinate(const Vec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

double offset_of(const Sphere& sphere) {
  return kRelativeOffset * (largest_coordinate(sphere.center) + sphere.radius);
}

double offset_of(const Mesh& mesh) {
  double extent = 0;
  for (const Vec3& position : mesh.positions) extent = std::max(extent, largest_coordinate(position));
  return kRelativeOffset * extent;
}

std::vector<Vec3> tangents_of(const Mesh& mesh) {
  return mesh.normals.empty() ? triangle_tangents(mesh) : vertex_tangents(mesh);
}

std::size_t material_of(const Scene& scene, int object) {
  return static_cast<std::size_t>(scene.objects[static_cast<std::size_t>(object)].material);
}

bool needs_coordinates(const SceneMaterial& material) { return material.relief || material.varies(); }

// --- spheres: Embree calls back, and the roots are found in double precision ---

const Sphere& sphere_of(void* user_pointer) { return *static_cast<const Surface*>(user_pointer)->sphere; }

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
  const Sphere& sphere = sphere_of(args->geometryUserPtr);
  const double reach = sphere.radius + offset_of(sphere);  // the margin covers rounding to float
  RTCBounds& bounds = *args->bounds_o;
  bounds.lower_x = static_cast<float>(sphere.center.x - reach);
  bounds.lower_y = static_cast<float>(sphere.center.y - reach);
  bounds.lower_z = static_cast<float>(sphere.center.z - reach);
  bounds.upper_x = static_cast<float>(sphere.center.x + reach);
  bounds.upper_y = static_cast<float>(sphere.center.y + reach);
  bounds.upper_z = static_cast<float>(sphere.center.z + reach);
}

// The first crossing within (tnear, tfar], or infinity.
double sphere_distance(const Sphere& sphere, const RTCRay& ray) {
  const Vec3 direction = {ray.dir_x, ray.dir_y, ray.dir_z};
  const Vec3 from_center = Vec3{ray.org_x, ray.org_y, ray.org_z} - sphere.center;
  const double inverse = 1 / dot(direction, direction);
  const double middle = -dot(from_center, direction) * inverse;
  const Vec3 closest = from_center + middle * direction;
  const double discriminant = (square(sphere.radius) - dot(closest, closest)) * inverse;
  if (!(discriminant >= 0)) return kInfinity;
  const double half_chord = std::sqrt(discriminant);
  for (const double t : {middle - half_chord, middle + half_chord})
    if (t > ray.tnear && t <= ray.tfar) return t;
  return kInfinity;
}

// Embree calls these with one ray at a time, because only single rays are traced here.
void sphere_intersect(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  auto& [ray, hit] = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  const double distance = sphere_distance(sphere_of(args->geometryUserPtr), ray);
  if (distance >= kInfinity) return;
  ray.tfar = static_cast<float>(distance);
  hit.u = hit.v = 0;
  hit.Ng_x = hit.Ng_y = hit.Ng_z = 0;
  hit.primID = args->primID;
  hit.geomID = args->geomID;
  hit.instID[0] = args->context->instID[0];
}

void sphere_occluded(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  if (sphere_distance(sphere_of(args->geometryUserPtr), ray) < kInfinity) ray.tfar = -kInfinity;
}

// --- geometry in Embree's memory ---

Geometry make_sphere(RTCDevice device, Surface& surface) {
  Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(geometry.get(), 1);
  rtcSetGeometryUserData(geometry.get(), &surface);
  rtcSetGeometryBoundsFunction(geometry.get(), sphere_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry.get(), sphere_intersect);
  rtcSetGeometryOccludedFunction(geometry.get(), sphere_occluded);
  return geometry;
}

// Embree reads the surface's own vertices and triangles.
Geometry make_mesh(RTCDevice device, const Surface& surface) {
  Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  const auto& triangles = surface.mesh->triangles;
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             surface.positions.data(), 0, sizeof(Float3), surface.mesh->positions.size());
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                             sizeof(triangles[0]), triangles.size());
  return geometry;
}

// --- hits: `point` is where Embree's distance, in single precision, leads along the ray ---

// Made of its members in place: SurfaceHit is too large to be copied.
using MaybeHit = std::optional<SurfaceHit>;

MaybeHit meet_sphere(const Surface& surface, const Ray& ray, const Vec3& point) {
  const Sphere& sphere = *surface.sphere;
  const Vec3 n = normalize(point - sphere.center), position = sphere.center + sphere.radius * n,
             tangent = unit_or_zero({-n.y, n.x, 0});
  Point2 uv;  // longitude and latitude, from 0 to 1 each
  UvDerivatives derivatives;
  if (surface.has_coordinates) {
    const double from_axis = std::hypot(n.x, n.y), longitude = std::atan2(n.y, n.x);
    uv = {longitude / (2 * kPi) + (longitude < 0 ? 1 : 0), std::atan2(n.z, from_axis) / kPi + 0.5};
    derivatives = {2 * kPi * sphere.radius * from_axis * tangent, kPi * sphere.radius * cross(n, tangent)};
  }
  return MaybeHit(std::in_place, position, n, n, tangent, uv, derivatives,
                  dot(position - ray.origin, ray.direction), surface.offset, surface.object, surface.light);
}

// A weighted mean of what the three vertices have.
struct Barycentric {
  explicit Barycentric(const RTCHit& hit) : u(hit.u), v(hit.v) {}
  template <class T>
  T operator()(const T& a, const T& b, const T& c) const {
    return (1 - u - v) * a + u * b + v * c;
  }
  double u, v;
};

Vec3 tangent_at(const Surface& surface, unsigned triangle, const Barycentric& mix) {
  if (surface.mesh->normals.empty()) return surface.tangents[triangle];
  const auto [i, j, k] = surface.mesh->triangles[triangle];
  return unit_or_zero(mix(surface.tangents[i], surface.tangents[j], surface.tangents[k]));
}

MaybeHit meet_triangle(const Surface& surface, const RTCHit& found, const Ray& ray, const Vec3& point) {
  const Barycentric mix(found);
  const Triangle& triangle = surface.triangles[found.primID];
  const Vec3 stored = to_double(triangle.normal);
  const Vec3 normal = (1.5 - 0.5 * dot(stored, stored)) * stored;  // a unit vector in double precision too
  const Vec3 position = point - dot(point - to_double(triangle.corner), normal) * normal;
  const auto& [a, b, c] = triangle.normals;
  const Vec3 mixed = mix(to_double(a), to_double(b), to_double(c));
  const double size = std::copysign(length(mixed), dot(mixed, normal));
  const Vec3 shading = size != 0 ? mixed / size : normal;

  Vec3 tangent;
  Point2 uv;
  UvDerivatives derivatives;
  if (!surface.tangents.empty()) tangent = tangent_at(surface, found.primID, mix);
  if (!surface.derivatives.empty()) {
    const auto [i, j, k] = surface.mesh->triangles[found.primID];
    const auto& uvs = surface.mesh->uvs;
    uv = {mix(uvs[i].x, uvs[j].x, uvs[k].x), mix(uvs[i].y, uvs[j].y, uvs[k].y)};
    const UvDerivatives &d = surface.derivatives[i], &e = surface.derivatives[j], &f = surface.derivatives[k];
    derivatives = {mix(d.du, e.du, f.du), mix(d.dv, e.dv, f.dv)};
  }
  return MaybeHit(std::in_place, position, normal, shading, tangent, uv, derivatives,
                  dot(position - ray.origin, ray.direction), surface.offset, surface.object, surface.light);
}

// Member by member: clearing all of it first takes longer.
void set_ray(RTCRay& to, const Ray& ray, float distance) {
  to.org_x = static_cast<float>(ray.origin.x);
  to.org_y = static_cast<float>(ray.origin.y);
  to.org_z = static_cast<float>(ray.origin.z);
  to.tnear = 0;
  to.dir_x = static_cast<float>(ray.direction.x);
  to.dir_y = static_cast<float>(ray.direction.y);
  to.dir_z = static_cast<float>(ray.direction.z);
  to.time = 0;
  to.tfar = distance;
  to.mask = ~0u;
  to.id = to.flags = 0;
}

}  // namespace

struct EmbreeScene::Impl {
  std::string error;  // the first message of the device; set before it, for its callback writes here
  std::vector<Mesh> light_meshes;
  std::vector<Sphere> light_spheres;
  std::vector<Surface> surfaces;
  Device device;
  SceneHandle scene;

  void collect(const Scene& source, const std::function<bool(std::size_t)>& is_isotropic);
  void build();
  void require_no_error() const {
    if (!error.empty()) throw Error("Embree: " + error);
  }
};

void EmbreeScene::Impl::collect(const Scene& source, const std::function<bool(std::size_t)>& is_isotropic) {
  light_meshes.reserve(source.quad_lights.size());  // surfaces point into it
  for (const QuadLight& light : source.quad_lights) {
    light_meshes.push_back(quad_mesh(light.corner, light.edge_u, light.edge_v));
    surfaces.push_back({.mesh = &light_meshes.back(), .light = static_cast<int>(light_meshes.size()) - 1});
  }
  light_spheres.reserve(source.sphere_lights.size());
  for (const SphereLight& light : source.sphere_lights) {
    light_spheres.push_back({light.center, light.radius});
    surfaces.push_back({.sphere = &light_spheres.back(), .light = static_cast<int>(surfaces.size())});
  }
  for (std::size_t i = 0; i < source.objects.size(); ++i) {
    const auto& shape = source.objects[i].shape;
    surfaces.push_back({.sphere = std::get_if<Sphere>(&shape),
                        .mesh = std::get_if<Mesh>(&shape),
                        .object = static_cast<int>(i)});
  }
  for (Surface& surface : surfaces) {
    surface.offset = surface.sphere ? offset_of(*surface.sphere) : offset_of(*surface.mesh);
    if (surface.mesh) {
      surface.positions = positions_of(*surface.mesh);
      surface.triangles = triangles_of(*surface.mesh, surface.positions);
    }
    if (surface.light >= 0) continue;
    const std::size_t material = material_of(source, surface.object);
    if (surface.mesh && !is_isotropic(material)) surface.tangents = tangents_of(*surface.mesh);
    surface.has_coordinates = needs_coordinates(source.materials[material]);
    if (surface.mesh && surface.has_coordinates) surface.derivatives = vertex_derivatives(*surface.mesh);
  }
}

void EmbreeScene::Impl::build() {
  device.reset(rtcNewDevice(nullptr));
  if (!device)
    throw Error(
        fmt::format("Embree: no device, error code {}", static_cast<int>(rtcGetDeviceError(nullptr))));
  const auto remember = [](void* first_error, RTCError code, const char* message) {
    auto& text = *static_cast<std::string*>(first_error);
    if (text.empty())
      text = fmt::format("error code {}: {}", static_cast<int>(code), message ? message : "no message");
  };
  rtcSetDeviceErrorFunction(device.get(), remember, &error);
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);  // no cracks between triangles
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Geometry geometry =
        surfaces[i].sphere ? make_sphere(device.get(), surfaces[i]) : make_mesh(device.get(), surfaces[i]);
    require_no_error();
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene.get(), geometry.get(), static_cast<unsigned>(i));
  }
  rtcCommitScene(scene.get());
  require_no_error();
}

EmbreeScene::EmbreeScene(const Scene& scene, const std::function<bool(std::size_t)>& is_isotropic)
    : impl_(std::make_unique<Impl>()) {
  impl_->collect(scene, is_isotropic);
  impl_->build();
}

EmbreeScene::~EmbreeScene() = default;

std::optional<SurfaceHit> EmbreeScene::intersect(const Ray& ray) const {
  RTCRayHit query;
  set_ray(query.ray, ray, kInfinity);
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect_one(impl_->scene.get(), query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const Surface& surface = impl_->surfaces[query.hit.geomID];
  const Vec3 point = ray.origin + double{query.ray.tfar} * ray.direction;
  return surface.sphere ? meet_sphere(surface, ray, point) : meet_triangle(surface, query.hit, ray, point);
}

bool EmbreeScene::occluded(const Ray& ray, double distance) const {
  RTCRay query;
  set_ray(query, ray, static_cast<float>(distance * kShadowFraction));
  occluded_one(impl_->scene.get(), query);
  return query.tfar < 0;
}

}  // namespace sunbeam
