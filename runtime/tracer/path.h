// This file is the path integrator: it samples lights and BSDFs at every vertex and combines both by the
// power heuristic.
//
// Surfaces are two-sided: at each hit the normals are flipped towards the viewer, so a BSDF always sees wo
// above the surface. Its local x axis is the direction of increasing u (turned by the material's
// tangent_rotation_deg), the same seen from either side; y follows, for the frame stays right-handed. Light
// must arrive above the shading AND above the geometric surface, hence none leaks through smooth-shaded
// meshes. What a relief (bump map) turns the normal by is corrected as runtime/tracer/relief.h tells.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "runtime/tracer/embree_scene.h"
#include "runtime/tracer/lights.h"
#include "runtime/tracer/pixel_sums.h"
#include "runtime/tracer/ray.h"
#include "runtime/tracer/sampler.h"
#include "runtime/tracer/surface_bsdf.h"

namespace sunbeam {

struct PathCounts {
  std::uint64_t rays = 0;      // towards hits and towards lights
  std::uint64_t vertices = 0;  // surface points where a BSDF was asked
};

class PathTracer {
 public:
  // bsdfs[i] belongs to scene.materials[i]. Everything passed must outlive this.
  PathTracer(const Scene& scene, const EmbreeScene& geometry, const Lights& lights,
             std::span<const SurfaceBsdf> bsdfs);

  // Returns one estimate of the radiance that arrives along `ray`; it is not finite if a BSDF returned
  // something not finite. `first` is filled in unless it is null.
  Rgb radiance(Ray ray, Sampler& sampler, PathCounts& counts, FirstHit* first) const;

 private:
  struct Vertex;
  struct Lit;
  using MaybeHit = std::optional<SurfaceHit>;

  Rgb emission(const Ray& ray, const MaybeHit& hit, std::optional<double> bsdf_pdf) const;
  std::optional<Lit> sample_light(const Vertex& vertex, const Random3& u, PathCounts& counts) const;
  Vertex make_vertex(const Ray& ray, const SurfaceHit& hit, BsdfRoom& room) const;

  const Scene& scene_;
  const EmbreeScene& geometry_;
  const Lights& lights_;
  std::span<const SurfaceBsdf> bsdfs_;
};

}  // namespace sunbeam
