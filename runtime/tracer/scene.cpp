#include "runtime/tracer/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>

#include "runtime/tracer/environment_map.h"
#include "runtime/tracer/mesh_file.h"
#include "runtime/tracer/scales.h"
#include "runtime/tracer/sky.h"
#include "runtime/tracer/snake.h"
#include "runtime/tracer/snake_scales.h"
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
    if (!(scale * value <= kEmission.high))
      table.fail("file",
                 fmt::format("holds the value {:g}; allowed: up to {:g} after scale", value, kEmission.high));
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
  EnvironmentMap loaded = load_named_file(table, load_environment_map);
  scene.environment.map = std::move(loaded.map);
  scene.warnings.insert(scene.warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
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

Point2 point2(const ConfigTable& table, std::string_view key, const Range& allowed) {
  const auto numbers = table.numbers(key, allowed);
  if (numbers.size() != 2)
    table.fail(key, fmt::format("found {} numbers; allowed: 2, along u and v", numbers.size()));
  return {numbers[0], numbers[1]};
}

HeightMap read_noise(const ConfigTable& table) {
  constexpr int kMostCells = 512;
  const int octaves = table.integer("octaves", 1, 8, 3);
  return noise_map(table.integer("cells", 1, kMostCells >> octaves, 4), octaves,
                   static_cast<std::uint64_t>(table.integer("seed", 0, std::numeric_limits<int>::max(), 1)));
}

// {from, to} and one of ramp, bands, noise and file.
ParameterField read_varying_field(const ConfigTable& table, const Range& allowed) {
  ParameterField field{
      .from = table.number("from", allowed), .to = table.number("to", allowed), .along = {}, .map = {}};
  if (table.has("ramp") + table.has("bands") + table.has("noise") + table.has("file") != 1)
    table.fail("from", "allowed beside from and to: exactly one of ramp, bands, noise and file");
  constexpr Range kRepeats{-1e4, 1e4}, kTiles{1e-3, 1e4};
  if (table.has("ramp") || table.has("bands")) {
    field.kind = table.has("ramp") ? ParameterField::Kind::ramp : ParameterField::Kind::bands;
    field.along = point2(table, table.has("ramp") ? "ramp" : "bands", kRepeats);
    return field;
  }
  field.kind = ParameterField::Kind::map;
  field.along = table.has("tiles") ? point2(table, "tiles", kTiles) : Point2{1, 1};
  field.map = std::make_shared<HeightMap>(table.has("noise") ? read_noise(table.table("noise"))
                                                             : load_named_file(table, load_height_map));
  return field;
}

std::optional<ParameterField> read_field(const ConfigTable& table, std::string_view key, double low) {
  if (!table.has(key)) return {};
  const Range allowed{low, Range().high};
  if (table.is_table(key)) return read_varying_field(table.table(key), allowed);
  return ParameterField::of(table.number(key, allowed));
}

std::shared_ptr<const HeightMap> scale_map(const ScaleLayout& layout, double edge, int pixels_across) {
  const int pixels = std::clamp(pixels_across / layout.columns, 8, 64);
  return std::make_shared<HeightMap>(scale_height_map(layout, edge, pixels));
}
constexpr int kMapPixels = 2048;  // across the whole map, which has all scales of a unit of u

double read_edge(const ConfigTable& table) { return table.number("edge", {0.02, 0.5}, 0.35); }
double read_scale_height(const ConfigTable& table) { return table.number("height", {-2, 2}, 0.12); }

// Of regular hexagons where a unit of v is as long as one of u.
double regular_rows(int around) { return 2 * around / std::numbers::sqrt3; }
int even_rows(double rows) { return 2 * static_cast<int>(std::lround(rows / 2)); }

// Whole rows of scutes to a unit of v, so that body and head meet where v is 0.
Relief read_snake_scales(const ConfigTable& table) {
  constexpr int kBodyPixels = 1024, kHeadPixels = 640;  // around; the shields are large
  const int around = table.integer("around", kMinSnakeColumns, kMaxSnakeColumns);
  const double edge = read_edge(table);
  const ScaleLayout body{.columns = around, .pattern = ScalePattern::snake_body};
  const ScaleLayout head{
      .columns = around, .rows = even_rows(regular_rows(around)), .pattern = ScalePattern::snake_head};
  return {.map = scale_map(body, edge, kBodyPixels),
          .tiles = {1, static_cast<double>(head.rows) / body.rows},
          .height = read_scale_height(table) / around,
          .head = scale_map(head, edge, kHeadPixels)};
}

// Scales by number: `around` of them to a unit of u and `rows` rows to a unit of v.
Relief read_scales(const ConfigTable& table) {
  const int pattern = table.choice("pattern", {"hexagonal", "voronoi", "snake"}, 0);
  if (pattern == 2) return read_snake_scales(table);
  const int around = table.integer("around", 1, kMaxScaleColumns);
  const double rows = table.number("rows", {1, 1e5}, regular_rows(around));
  ScaleLayout layout;
  if (pattern == 1) {
    layout.columns = around;
    layout.rows = std::clamp(even_rows(rows), 2, kMaxScaleColumns);
    layout.jitter = table.number("jitter", {0, 1}, 1.0);
    layout.seed = static_cast<std::uint64_t>(table.integer("seed", 0, std::numeric_limits<int>::max(), 1));
  }
  return {.map = scale_map(layout, read_edge(table), kMapPixels),
          .tiles = {static_cast<double>(around) / layout.columns, rows / layout.rows},
          .height = read_scale_height(table) / around};
}

Relief read_bump(const ConfigTable& table) {
  HeightMap map = load_named_file(table, load_height_map);
  const Point2 tiles = table.has("tiles") ? point2(table, "tiles", {1e-3, 1e5}) : Point2{1, 1};
  return {.map = std::make_shared<HeightMap>(std::move(map)),
          .tiles = tiles,
          .height = table.number("height", {-2, 2}) / tiles.x};
}

std::optional<Relief> read_relief(const ConfigTable& table) {
  if (table.has("scales") && table.has("bump"))
    table.fail("bump", "cannot stand beside scales; allowed: one of the two");
  if (table.has("scales")) return read_scales(table.table("scales"));
  if (table.has("bump")) return read_bump(table.table("bump"));
  return {};
}

void read_skin(const ConfigTable& table, SceneMaterial& material) {
  constexpr std::array<double, 3> kLowest = {0, 1, 0};
  for (std::size_t k = 0; k < kParameterNames.size(); ++k)
    material.parameters[k] = read_field(table, kParameterNames[k], kLowest[k]);
  material.tangent_rotation_deg = table.number("tangent_rotation_deg", {-360, 360}, 0.0);
}

SceneMaterial read_material(const ConfigTable& table) {
  SceneMaterial material;
  material.name = table.string("name");
  material.relief = read_relief(table);
  material.relief_key = table.has("scales") ? "scales" : "bump";
  switch (table.choice("type", {"skin", "diffuse", "gloss"})) {
    case 0:
      material.type = SceneMaterial::Type::skin;
      read_skin(table, material);
      break;
    case 1:
      material.type = SceneMaterial::Type::diffuse;
      material.albedo = table.rgb("albedo", kUnit, material.albedo);
      break;
    default:
      material.type = SceneMaterial::Type::gloss;
      material.ior = table.number("ior", {1.01, 4}, material.ior);
      material.roughness = table.number("roughness", {1e-3, 1}, material.roughness);
  }
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

// `center` of the shapes that have one moves them after all else.
Transform read_transform(const ConfigTable& table) {
  return {.scale = table.number("scale", kLength, 1.0),
          .rotate_deg = point(table, "rotate_deg", Vec3{}),
          .translate = point(table, "translate", Vec3{})};
}

Mesh read_torus(const ConfigTable& table) {
  const double major = table.number("major_radius", kLength);
  const double minor = table.number("minor_radius", kLength);
  if (minor >= major)
    table.fail("minor_radius", fmt::format("found {:g}; allowed: below major_radius, {:g}", minor, major));
  return torus_mesh({}, major, minor, {}, table.integer("resolution", 8, 4096, 128));
}

Mesh read_plane(const ConfigTable& table) {
  const Frame frame = Frame::from_normal(direction(table, "normal", Vec3{0, 0, 1}));
  const double half_size = table.number("half_size", kLength, 50.0);
  const Vec3 u = 2 * half_size * frame.tangent, v = 2 * half_size * frame.bitangent;
  return quad_mesh(-0.5 * (u + v), u, v);
}

Snake read_snake(const ConfigTable& table) {
  SnakeShape shape;
  shape.body_radius = table.number("body_radius", kLength, shape.body_radius);
  shape.turns = table.number("turns", {1, 6}, shape.turns);
  shape.resolution = table.integer("resolution", 16, 1024, shape.resolution);
  return make_snake(shape);
}

Mesh read_mesh(const ConfigTable& table, std::vector<std::string>& warnings) {
  const std::string folder = std::filesystem::path(table.file()).parent_path().string();
  LoadedMesh loaded = load_named_file(
      table, [&](const std::string& path) { return load_mesh(path, folder.empty() ? "." : folder); });
  if (loaded.dropped > 0)
    warnings.push_back(
        fmt::format("{}: {} triangles without area are left out", table.string("file"), loaded.dropped));
  return std::move(loaded.mesh);
}

// Names what of a material stays constant on a mesh without texture coordinates.
void warn_without_coordinates(const std::string& file, const SceneMaterial& material, Scene& scene) {
  std::vector<std::string> keys;
  for (std::size_t k = 0; k < kParameterNames.size(); ++k)
    if (material.parameters[k] && !material.parameters[k]->is_constant()) keys.push_back(kParameterNames[k]);
  if (material.relief) keys.push_back(material.relief_key);
  if (keys.empty()) return;
  const std::string warning =
      fmt::format("{}: the mesh has no texture coordinates, so {} of material \"{}\" cannot vary over it",
                  file, fmt::join(keys, ", "), material.name);
  if (std::find(scene.warnings.begin(), scene.warnings.end(), warning) == scene.warnings.end())
    scene.warnings.push_back(warning);
}

// A sphere is exact, or a mesh if it has a `resolution`; only that can be turned.
std::variant<Sphere, Mesh> read_sphere(const ConfigTable& table, const Transform& transform) {
  const double radius = table.number("radius", kLength);
  if (table.has("resolution"))
    return transformed(sphere_mesh(radius, table.integer("resolution", 8, 4096)), transform);
  if (table.has("rotate_deg")) table.fail("rotate_deg", "turns no exact sphere; allowed beside resolution");
  return Sphere{transform.translate, transform.scale * radius};
}

void require_mesh_coordinates(const ConfigTable& table, const Mesh& mesh) {
  for (const Vec3& position : mesh.positions)
    for (const double coordinate : {position.x, position.y, position.z})
      if (std::abs(coordinate) > kMaxCoordinate)
        table.fail("type", fmt::format("the object reaches {:g}; allowed: {:g} to {:g}", coordinate,
                                       -kMaxCoordinate, kMaxCoordinate));
}

Mesh placed(const ConfigTable& table, Mesh mesh, const Transform& transform) {
  mesh = transformed(std::move(mesh), transform);
  require_mesh_coordinates(table, mesh);
  return mesh;
}

int find_material(const ConfigTable& table, std::string_view key,
                  const std::vector<SceneMaterial>& materials) {
  const std::string name = table.string(key);
  std::vector<std::string> names;
  for (const auto& material : materials) names.push_back(material.name);
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<int>(at - names.begin());
  if (names.empty()) table.fail(key, fmt::format("found \"{}\", but the scene has no [[material]]", name));
  table.fail(key, fmt::format("found \"{}\"; the nearest material is \"{}\"; allowed: \"{}\"", name,
                              nearest(name, names), fmt::join(names, "\", \"")));
}

// The eyes of snakes go to a list of their own.
void read_object(const ConfigTable& table, Scene& scene, std::vector<SceneObject>& eyes) {
  const int type = table.choice("type", {"sphere", "torus", "plane", "mesh", "snake"});
  const int material = find_material(table, "material", scene.materials);
  Transform transform = read_transform(table);
  if (type <= 2) transform.translate = transform.translate + point(table, "center", Vec3{});
  switch (type) {
    case 0:
      scene.objects.push_back({read_sphere(table, transform), material});
      break;
    case 1:
      scene.objects.push_back({placed(table, read_torus(table), transform), material});
      break;
    case 2:
      scene.objects.push_back({placed(table, read_plane(table), transform), material});
      break;
    case 3:
      scene.objects.push_back({placed(table, read_mesh(table, scene.warnings), transform), material});
      if (std::get<Mesh>(scene.objects.back().shape).uvs.empty())
        warn_without_coordinates(table.string("file"), scene.materials[static_cast<std::size_t>(material)],
                                 scene);
      break;
    default: {
      const Snake snake = read_snake(table);
      scene.objects.push_back({placed(table, snake.skin, transform), material});
      eyes.push_back(
          {placed(table, snake.eyes, transform),
           table.has("eye_material") ? find_material(table, "eye_material", scene.materials) : material});
    }
  }
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
  std::vector<SceneObject> eyes;
  for (const auto& table : config.tables("object")) read_object(table, scene, eyes);
  // Last, so that errors count the objects as the file does.
  scene.objects.insert(scene.objects.end(), eyes.begin(), eyes.end());
  config.finish();
  scene.files = config.resolved_files();
  if (scene.objects.empty()) config.fail("object", "found none; allowed: at least one [[object]]");
  return scene;
}

Scene load_scene(const std::string& path, const std::vector<std::string>& overrides) {
  return read_scene(ConfigTable::load(path, overrides));
}

}  // namespace sunbeam
