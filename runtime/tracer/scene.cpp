#include "runtime/tracer/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "runtime/tracer/image_io.h"
#include "runtime/tracer/obj.h"
#include "runtime/tracer/sky.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/frame.h"

namespace sunbeam {
namespace {

// Lengths outside these limits lose all precision in single-precision ray tracing.
constexpr double kMaxCoordinate = 1e6;
constexpr Range kLength{1e-6, kMaxCoordinate};
constexpr Range kEmission{0, 1e9};
constexpr Range kUnit{0, 1};

void require_coordinates(const ConfigTable& table, std::string_view key, const Vec3& value) {
  for (const double coordinate : {value.x, value.y, value.z})
    if (std::abs(coordinate) > kMaxCoordinate)
      table.fail(
          key, fmt::format("found {:g}; allowed: {:g} to {:g}", coordinate, -kMaxCoordinate, kMaxCoordinate));
}

Vec3 point(const ConfigTable& table, std::string_view key, std::optional<Vec3> fallback = {}) {
  const Vec3 value = table.vec3(key, fallback);
  require_coordinates(table, key, value);
  return value;
}

Vec3 direction(const ConfigTable& table, std::string_view key, std::optional<Vec3> fallback = {}) {
  const Vec3 value = point(table, key, fallback);
  if (length(value) < kLength.low) table.fail(key, "found a vector of length 0; allowed: any other");
  return normalize(value);
}

// |sin| of the angle between two vectors.
double sine_between(const Vec3& a, const Vec3& b) { return length(cross(normalize(a), normalize(b))); }

CameraView read_camera(const ConfigTable& table) {
  CameraView camera;
  camera.position = point(table, "position");
  camera.look_at = point(table, "look_at");
  camera.up = direction(table, "up", camera.up);
  camera.fov_deg = table.number("fov_deg", {0.1, 175}, camera.fov_deg);
  if (length(camera.look_at - camera.position) < kLength.low)
    table.fail("look_at", "is the same point as position; allowed: any other point");
  if (sine_between(camera.look_at - camera.position, camera.up) < 1e-6)
    table.fail("up", "is parallel to the view from position to look_at; allowed: any other direction");
  if (table.choice("fov_axis", {"vertical", "horizontal"}, 0) == 1)
    camera.fov_axis = CameraView::FovAxis::horizontal;
  camera.lens_radius = table.number("lens_radius", {0, kLength.high}, 0.0);
  camera.inside = table.boolean("inside", false);
  camera.focus_distance = table.number("focus_distance", kLength, length(camera.look_at - camera.position));
  return camera;
}

RenderDefaults read_render(const ConfigTable& table) {
  RenderDefaults render;
  render.width = table.integer("width", 1, 16384, render.width);
  render.height = table.integer("height", 1, 16384, render.height);
  render.spp = table.integer("spp", 1, 1 << 24, render.spp);
  render.max_bounces = table.integer("max_bounces", 1, 10000, render.max_bounces);
  render.roulette_after = table.integer("roulette_after", 0, 10000, render.roulette_after);
  return render;
}

// What `load` makes of the file that key `file` names; its errors are told with the place in the scene.
template <class Load>
auto load_named_file(const ConfigTable& table, Load load) {
  const std::string path = table.resolve(table.string("file"));
  try {
    return load(path);
  } catch (const Error& error) {
    table.fail("file", error.what());
  }
}

void scale_radiance(const ConfigTable& table, Image& map, double scale) {
  for (float& value : map.rgb) {
    if (!(value >= 0 && scale * value <= kEmission.high))
      table.fail("file",
                 fmt::format("holds the value {:g}; allowed: 0 to {:g} after scale", value, kEmission.high));
    value = static_cast<float>(scale * value);
  }
}

// The sky and, unless `sun = false`, its sun, which is a directional light.
void read_sky(const ConfigTable& table, double scale, Scene& scene) {
  constexpr int kSkyWidth = 512;
  Sky sky{.sun_direction = direction(table, "sun_direction"),
          .turbidity = table.number("turbidity", {2, 10}, Sky().turbidity),
          .ground_albedo = table.rgb("ground_albedo", kUnit, Rgb(0.1)),
          .scale = scale};
  if (sky.sun_direction.z < 0)
    table.fail("sun_direction", "points below the horizon; allowed: z of 0 or more");
  scene.environment.map = sky_map(sky, kSkyWidth, kSkyWidth / 2);
  if (!table.boolean("sun", true)) return;
  const SunLight sun = sun_light(sky);
  scene.directional_lights.push_back({sun.direction, sun.irradiance, sun.angular_radius * (360 / kPi)});
}

void read_environment(const ConfigTable& table, Scene& scene) {
  const int given = table.has("file") + table.has("color") + table.has("sky");
  if (given > 1) table.fail("color", "found more than one of color, file and sky; allowed: one of them");
  const double scale = table.number("scale", kEmission, 1.0);
  if (table.has("sky") && scale > 0) return read_sky(table.table("sky"), scale, scene);
  if (!table.has("file")) {
    scene.environment.color = scale * table.rgb("color", kEmission, Rgb());
    return;
  }
  scene.environment.map = load_named_file(table, read_exr).mean;
  scale_radiance(table, scene.environment.map, scale);
}

QuadLight read_quad_light(const ConfigTable& table) {
  QuadLight light;
  light.edge_u = point(table, "edge_u");
  light.edge_v = point(table, "edge_v");
  if (length(light.edge_u) < kLength.low || length(light.edge_v) < kLength.low ||
      sine_between(light.edge_u, light.edge_v) < 1e-6)
    table.fail("edge_v", "spans no area with edge_u; allowed: two edges that are neither 0 nor parallel");
  if (table.has("corner") == table.has("center"))
    table.fail("corner", "allowed: exactly one of corner and center");
  light.corner = table.has("corner") ? point(table, "corner")
                                     : point(table, "center") - 0.5 * (light.edge_u + light.edge_v);
  light.radiance = table.rgb("radiance", kEmission);
  return light;
}

SphereLight read_sphere_light(const ConfigTable& table) {
  return {point(table, "center"), table.number("radius", kLength), table.rgb("radiance", kEmission)};
}

DirectionalLight read_directional_light(const ConfigTable& table) {
  return {direction(table, "towards"), table.rgb("irradiance", kEmission),
          table.number("angle_deg", {0, 90}, 0.0)};
}

void read_light(const ConfigTable& table, Scene& scene) {
  switch (table.choice("type", {"quad", "sphere", "point", "directional"})) {
    case 0:
      scene.quad_lights.push_back(read_quad_light(table));
      break;
    case 1:
      scene.sphere_lights.push_back(read_sphere_light(table));
      break;
    case 2:
      scene.point_lights.push_back({point(table, "position"), table.rgb("intensity", kEmission)});
      break;
    default:
      scene.directional_lights.push_back(read_directional_light(table));
  }
}

std::optional<double> optional_number(const ConfigTable& table, std::string_view key, double low) {
  if (!table.has(key)) return {};
  return table.number(key, {low, Range().high});
}

SceneMaterial read_material(const ConfigTable& table) {
  SceneMaterial material;
  material.name = table.string("name");
  if (table.choice("type", {"skin", "diffuse"}) == 1) {
    material.type = SceneMaterial::Type::diffuse;
    material.albedo = table.rgb("albedo", kUnit, material.albedo);
    return material;
  }
  material.type = SceneMaterial::Type::skin;
  material.film_thickness_nm = optional_number(table, "film_thickness_nm", 0);
  material.base_ior = optional_number(table, "base_ior", 1);
  material.absorption_per_nm = optional_number(table, "absorption_per_nm", 0);
  material.tangent_rotation_deg = table.number("tangent_rotation_deg", {-360, 360}, 0.0);
  return material;
}

std::vector<SceneMaterial> read_materials(const ConfigTable& config) {
  std::vector<SceneMaterial> materials;
  for (const auto& table : config.tables("material")) {
    const SceneMaterial material = read_material(table);
    for (const auto& other : materials)
      if (other.name == material.name)
        table.fail("name", fmt::format("found \"{}\" a second time; allowed: each name once", material.name));
    materials.push_back(material);
  }
  return materials;
}

Mesh read_torus(const ConfigTable& table) {
  const double major = table.number("major_radius", kLength);
  const double minor = table.number("minor_radius", kLength);
  if (minor >= major)
    table.fail("minor_radius", fmt::format("found {:g}; allowed: below major_radius, {:g}", minor, major));
  return torus_mesh(point(table, "center"), major, minor, point(table, "rotate_deg", Vec3{}),
                    table.integer("resolution", 8, 4096, 128));
}

Mesh read_plane(const ConfigTable& table) {
  const Vec3 center = point(table, "center", Vec3{});
  const Frame frame = Frame::from_normal(direction(table, "normal", Vec3{0, 0, 1}));
  const double half_size = table.number("half_size", kLength, 50.0);
  const Vec3 u = 2 * half_size * frame.tangent, v = 2 * half_size * frame.bitangent;
  return quad_mesh(center - 0.5 * (u + v), u, v);
}

Mesh read_mesh(const ConfigTable& table) {
  const double scale = table.number("scale", kLength, 1.0);
  const Vec3 translate = point(table, "translate", Vec3{});
  const Mesh mesh =
      load_named_file(table, [&](const std::string& path) { return load_obj(path, scale, translate); });
  for (const Vec3& position : mesh.positions) require_coordinates(table, "file", position);
  return mesh;
}

std::variant<Sphere, Mesh> read_shape(const ConfigTable& table) {
  switch (table.choice("type", {"sphere", "torus", "plane", "mesh"})) {
    case 0:
      return Sphere{point(table, "center"), table.number("radius", kLength)};
    case 1:
      return read_torus(table);
    case 2:
      return read_plane(table);
    default:
      return read_mesh(table);
  }
}

int find_material(const ConfigTable& table, const std::vector<SceneMaterial>& materials) {
  const std::string name = table.string("material");
  std::vector<std::string> names;
  for (const auto& material : materials) names.push_back(material.name);
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<int>(at - names.begin());
  if (names.empty())
    table.fail("material", fmt::format("found \"{}\", but the scene has no [[material]]", name));
  table.fail("material", fmt::format("found \"{}\"; the nearest material is \"{}\"; allowed: \"{}\"", name,
                                     nearest(name, names), fmt::join(names, "\", \"")));
}

}  // namespace

Scene read_scene(const ConfigTable& config) {
  Scene scene;
  if (config.has("recipe")) scene.recipe = config.resolve(config.string("recipe"));
  if (config.has("table")) scene.table = config.resolve(config.string("table"));
  scene.diffuse_albedo = config.rgb("diffuse_albedo", kUnit, scene.diffuse_albedo);
  scene.camera = read_camera(config.table("camera"));
  scene.render = read_render(config.table("render"));
  read_environment(config.table("environment"), scene);
  for (const auto& light : config.tables("light")) read_light(light, scene);
  scene.materials = read_materials(config);
  for (const auto& table : config.tables("object"))
    scene.objects.push_back({read_shape(table), find_material(table, scene.materials)});
  config.finish();
  if (scene.objects.empty()) config.fail("object", "found none; allowed: at least one [[object]]");
  return scene;
}

Scene load_scene(const std::string& path, const std::vector<std::string>& overrides) {
  return read_scene(ConfigTable::load(path, overrides));
}

}  // namespace sunbeam
