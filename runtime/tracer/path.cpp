#include "runtime/tracer/path.h"

#include <limits>

#include "runtime/tracer/relief.h"
#include "sunbeam/core/frame.h"

namespace sunbeam {
namespace {

// MIS weight of the technique with density `pdf` against one other.
double power_heuristic(double pdf, double other) {
  return pdf <= 0 ? 0 : 1 / (1 + square(other / pdf));  // as a ratio, for squares overflow
}

// Interpolation can turn a shading normal away from the viewer; then it is bent until it just faces wo again.
Vec3 bend_towards(const Vec3& normal, const Vec3& wo) {
  constexpr double kGrazing = 1e-3;
  const double cosine = dot(normal, wo);
  return cosine >= kGrazing ? normal : normalize(normal + (kGrazing - cosine) * wo);
}

// The direction of the local x axis: `tangent` turned counter-clockwise about `normal`.
Vec3 turned_tangent(const Vec3& tangent, const Vec3& normal, double degrees) {
  if (degrees == 0) return tangent;
  const double angle = degrees * (kPi / 180);
  const Frame frame = Frame::from_normal_and_tangent(normal, tangent);
  return frame.to_world({std::cos(angle), std::sin(angle), 0});
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

struct PathTracer::Vertex {
  Vec3 position, geometric_normal;  // the normal on the viewer's side
  Frame frame;                      // shading frame
  Vec3 wo;                          // local
  double offset;
  const Bsdf* bsdf;
  const SceneMaterial* material;
  Point2 uv;
  std::optional<Vec3> smooth_normal;  // on the viewer's side, where a relief turned that of the frame

  bool is_above(const Vec3& world) const { return dot(world, geometric_normal) > 0; }
  double shadowing(const Vec3& world) const {
    return smooth_normal ? terminator_shadowing(frame.normal, *smooth_normal, world) : 1;
  }
  FirstHit as_first_hit(double distance) const {
    return {.on_surface = true,
            .albedo = {},  // known when the BSDF is sampled
            .shading_normal = frame.normal,
            .geometric_normal = geometric_normal,
            .depth = distance,
            .film_thickness_nm = material->parameters[0] ? material->parameters[0]->at(uv) : 0};
  }
  // Where rays start, off the surface.
  Vec3 origin() const { return position + offset * geometric_normal; }
  Ray leave(const Vec3& world) const { return {origin(), world}; }
};

PathTracer::PathTracer(const Scene& scene, const EmbreeScene& geometry, const Lights& lights,
                       std::span<const SurfaceBsdf> bsdfs)
    : scene_(scene), geometry_(geometry), lights_(lights), bsdfs_(bsdfs) {}

// Inlined, as all that radiance() calls once: results would go through memory otherwise.
[[gnu::always_inline]] inline PathTracer::Vertex PathTracer::make_vertex(const Ray& ray,
                                                                         const SurfaceHit& hit,
                                                                         BsdfRoom& room) const {
  const Vec3 wo = -ray.direction;
  const double side = dot(wo, hit.geometric_normal) < 0 ? -1 : 1;
  const auto material =
      static_cast<std::size_t>(scene_.objects[static_cast<std::size_t>(hit.object)].material);
  const SceneMaterial& description = scene_.materials[material];
  const Vec3 geometric = side * hit.geometric_normal;
  Vec3 normal = bend_towards(side * hit.shading_normal, wo);
  std::optional<Vec3> smooth;
  if (description.relief) {
    smooth = normal;
    const Vec3 turned = relief_normal(*description.relief, hit.uv, hit.shading_normal, hit.derivatives);
    normal = valid_normal(side * turned, geometric, wo);
  }
  const Vec3 tangent = turned_tangent(hit.tangent, hit.shading_normal, description.tangent_rotation_deg);
  const Frame frame = Frame::from_normal_and_tangent(normal, tangent);
  const SurfaceBsdf& bsdf = bsdfs_[material];
  return {
      hit.position, geometric,
      frame,        frame.to_local(wo),
      hit.offset,   bsdf.uniform ? bsdf.uniform : &bsdf.varying->at(description.parameters_at(hit.uv), room),
      &description, hit.uv,
      smooth};
}

// What the end of `ray` emits, weighted by MIS if the ray was drawn with density `bsdf_pdf`. Without one
// (from the camera or from a Dirac lobe) no light sample could have found the same path, and all of it
// counts.
inline Rgb PathTracer::emission(const Ray& ray, const MaybeHit& hit, std::optional<double> bsdf_pdf) const {
  Rgb sum;
  const auto add = [&](const Emission& light) {
    sum +=
        bsdf_pdf && light.pdf > 0 ? light.radiance * power_heuristic(*bsdf_pdf, light.pdf) : light.radiance;
  };
  if (!hit)
    lights_.for_each_far_off(ray.origin, ray.direction, add);
  else if (hit->light >= 0)
    add(lights_.surface(hit->light, ray.origin, ray.direction, hit->distance));
  return sum;
}

// A light sample that reaches the vertex.
struct PathTracer::Lit {
  LightSample light;
  Vec3 wi;  // local
  double shadowing;

  Rgb reflected(const EvalPdf& at) const {
    const double weight = light.is_dirac ? 1 : power_heuristic(light.pdf, at.pdf);
    return at.f * light.radiance * (wi.z * weight * shadowing / light.pdf);
  }
};

inline std::optional<PathTracer::Lit> PathTracer::sample_light(const Vertex& vertex, const Random3& u,
                                                               PathCounts& counts) const {
  const auto light = lights_.sample(vertex.origin(), u);
  if (!light || !vertex.is_above(light->wi)) return {};
  const Vec3 wi = vertex.frame.to_local(light->wi);
  if (wi.z <= 0) return {};
  const double shadowing = vertex.shadowing(light->wi);
  if (shadowing == 0) return {};
  ++counts.rays;
  if (geometry_.occluded(vertex.leave(light->wi), light->distance)) return {};
  return Lit{*light, wi, shadowing};
}

Rgb PathTracer::radiance(Ray ray, Sampler& sampler, PathCounts& counts, FirstHit* first) const {
  Rgb result, throughput(1);
  std::optional<double> bsdf_pdf;
  for (int bounce = 0;; ++bounce) {
    ++counts.rays;
    const MaybeHit hit = geometry_.intersect(ray);
    result += throughput * emission(ray, hit, bsdf_pdf);
    if (!hit || hit->light >= 0 || bounce == scene_.render.max_bounces) return result;

    ++counts.vertices;
    BsdfRoom room;
    const Vertex vertex = make_vertex(ray, *hit, room);
    if (first && bounce == 0) *first = vertex.as_first_hit(hit->distance);
    const auto lit = sample_light(vertex, sampler.next3(), counts);
    const Random3 u = sampler.next3();
    const auto [eval, sample] = lit ? vertex.bsdf->eval_and_sample(vertex.wo, lit->wi, u, sampler.rng())
                                    : EvalAndSample{{}, vertex.bsdf->sample(vertex.wo, u, sampler.rng())};
    if (lit) result += throughput * lit->reflected(eval);
    if (!sample) return result;
    throughput *= sample->throughput;
    if (first && bounce == 0) first->albedo = sample->throughput;
    if (!is_finite(sample->wi) || !is_finite(throughput))
      return Rgb(std::numeric_limits<double>::quiet_NaN());
    const Vec3 wi = vertex.frame.to_world(sample->wi);
    if (sample->wi.z <= 0 || !vertex.is_above(wi)) return result;
    const double shadowing = vertex.shadowing(wi);
    if (shadowing == 0) return result;
    throughput *= shadowing;
    if (bounce >= scene_.render.roulette_after) {
      // Colours outside Rec.709 have negative components, which weigh as much.
      const double survival =
          std::min(1.0, max_component(transform(throughput, [](double x) { return std::abs(x); })));
      if (sampler.rng().uniform() >= survival) return result;
      throughput *= 1 / survival;
    }
    bsdf_pdf = sample->is_dirac ? std::nullopt : std::optional(sample->mis_pdf);
    ray = vertex.leave(wi);
  }
}

}  // namespace sunbeam
