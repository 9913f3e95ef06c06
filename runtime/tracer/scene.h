// This file holds a scene, read from TOML and complete in memory: meshes are tessellated and pictures loaded.
// World space has z up; lengths are in one arbitrary unit. Whoever builds a Scene by hand must keep to the
// same limits.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "runtime/config/config.h"
#include "runtime/tracer/image.h"
#include "runtime/tracer/mesh.h"
#include "runtime/tracer/parameter_field.h"
#include "runtime/tracer/relief.h"
#include "sunbeam/core/vec.h"
#include "sunbeam/parameters.h"

namespace sunbeam {

struct CameraView {
  Vec3 position, look_at;
  Vec3 up{0, 0, 1};     // not parallel to the view
  double fov_deg = 40;  // angle of view, (0, 180)
  enum class FovAxis { vertical, horizontal } fov_axis = FovAxis::vertical;
  // The lens is thin: points at `focus_distance` along the view are sharp. Radius 0 is a pinhole.
  double lens_radius = 0;
  double focus_distance = 1;
  bool inside = false;  // a position inside a closed object is wanted, not a mistake
};

// Holds what RenderSettings falls back to.
struct RenderDefaults {
  int width = 640, height = 360;
  int spp = 64;            // samples per pixel
  int max_bounces = 8;     // scattering events of a path; 1 = direct light only
  int roulette_after = 3;  // scattering events before Russian roulette; max_bounces or more: never
};

// Describes the radiance from infinity. `map` is a lat-long picture seen from inside, unmirrored: rows run
// from +z (top) to -z (bottom), the centre column looks along +x, the left quarter along +y. Texels are
// constant, not blended.
struct EnvironmentSource {
  Rgb color;  // used if `map` is empty
  Image map;  // finite, >= 0, scale applied
};

// A quad light is a parallelogram that emits on the side of cross(edge_u, edge_v) only; the other side is
// black and opaque.
struct QuadLight {
  Vec3 corner, edge_u, edge_v;
  Rgb radiance;
};

// A sphere light emits outwards, the same radiance everywhere.
struct SphereLight {
  Vec3 center;
  double radius = 1;
  Rgb radiance;
};

struct PointLight {
  Vec3 position;
  Rgb intensity;  // W/sr
};

// A directional light is the sun: far off, a disc of uniform radiance that is seen in the sky; without size
// it cannot be seen.
struct DirectionalLight {
  Vec3 towards;          // unit, from the scene to the light
  Rgb irradiance;        // at normal incidence
  double angle_deg = 0;  // diameter, [0, 90]
};

struct SceneMaterial {
  enum class Type { skin, diffuse, gloss };
  std::string name;
  Type type = Type::diffuse;
  Rgb albedo{0.5};                      // type diffuse only
  double ior = 1.33, roughness = 0.05;  // type gloss only: a dielectric over black, roughness its GGX alpha
  // Only type skin has these, which replace the values of the recipe.
  std::array<std::optional<ParameterField>, 3> parameters;  // in the order of kParameterNames
  // Turns the local x axis of the BSDF away from the direction of increasing u, counter-clockwise about the
  // shading normal on the outer side of the surface (that of its winding).
  double tangent_rotation_deg = 0;
  std::optional<Relief> relief;  // bump map
  std::string relief_key;        // of the scene file, "scales" or "bump"

  // Says whether a parameter depends on the texture coordinates.
  bool varies() const {
    return std::any_of(parameters.begin(), parameters.end(),
                       [](const auto& field) { return field && !field->is_constant(); });
  }
  // Returns the parameters at these texture coordinates; 0 where no field is given.
  Parameters parameters_at(const Point2& uv) const {
    const auto value = [&](std::size_t k) { return parameters[k] ? parameters[k]->at(uv) : 0; };
    return {value(0), value(1), value(2)};
  }
};

struct Sphere {
  Vec3 center;
  double radius = 1;
};

struct SceneObject {
  std::variant<Sphere, Mesh> shape;
  int material = 0;  // index into Scene::materials
};

struct Scene {
  std::string recipe, table;  // paths, relative to the scene file already resolved; "" if not named
  Rgb diffuse_albedo{0.5};
  CameraView camera;
  RenderDefaults render;
  EnvironmentSource environment;
  std::vector<QuadLight> quad_lights;
  std::vector<SphereLight> sphere_lights;
  std::vector<PointLight> point_lights;
  std::vector<DirectionalLight> directional_lights;
  std::vector<SceneMaterial> materials;
  std::vector<SceneObject> objects;   // those of the file, then the eyes of its snakes
  std::vector<std::string> files;     // all that the scene names, resolved
  std::vector<std::string> warnings;  // a line each, for people: what was left out of files or cannot be used
};

// Reads a scene. Throws Error for anything missing, out of range, unknown or degenerate, in the file or in
// what it names. `recipe` and `table` are resolved but not opened.
Scene read_scene(const ConfigTable& config);
// Reads a scene from a file; `overrides` are those of ConfigTable::load.
Scene load_scene(const std::string& path, const std::vector<std::string>& overrides = {});

}  // namespace sunbeam
