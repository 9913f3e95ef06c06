// This file finds visibility and nearest hits through Embree. No file but embree_* includes Embree.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "runtime/tracer/ray.h"
#include "runtime/tracer/scene.h"
#include "runtime/tracer/tangents.h"

namespace sunbeam {

struct SurfaceHit {
  Vec3 position;          // on the surface, to double precision (spheres) or single precision (meshes)
  Vec3 geometric_normal;  // unit; out of a sphere, by the winding of a triangle
  Vec3 shading_normal;    // unit, interpolated, on the side of the geometric normal
  // It is unit, along dp/du (increasing u), continuous over smooth meshes; only nearly perpendicular to the
  // shading normal. u of a sphere is the longitude about its z axis. It is zero where no direction is known:
  // without texture coordinates, where they are degenerate, at the poles of a sphere.
  Vec3 tangent;
  // These are texture coordinates and dp/du, dp/dv, interpolated. Only objects whose material needs them,
  // having a relief or varying, have them; else they are 0.
  Point2 uv;
  UvDerivatives derivatives;
  double distance;  // from the origin of the ray
  double offset;    // a ray that starts this far above `position` does not hit the same surface again
  int object;       // index into Scene::objects, -1 for a light
  int light;        // counts Scene::quad_lights, then sphere_lights; -1 for an object
};

class EmbreeScene {
 public:
  // Builds the search structure. `scene` must outlive this. `is_isotropic` tells of which of its materials
  // SurfaceHit::tangent need not be found; it is then 0 on meshes. Throws Error with Embree's message if it
  // fails.
  explicit EmbreeScene(
      const Scene& scene,
      const std::function<bool(std::size_t material)>& is_isotropic = [](std::size_t) { return false; });
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  // Returns the nearest hit, on either side of a surface. It is thread-safe.
  std::optional<SurfaceHit> intersect(const Ray& ray) const;

  // Says whether anything lies between the origin and a point `distance` away (infinite: anywhere). The last
  // 0.01 % of the way is left out, so that the light at the end does not shadow itself. It is thread-safe.
  bool occluded(const Ray& ray, double distance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sunbeam
