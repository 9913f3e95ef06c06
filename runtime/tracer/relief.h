// This file does bump mapping: a height map turns the shading normal of a surface that stays where it is.
//
// Two corrections keep the turned normal from leaking light and from black terminators:
// - Towards the viewer, valid_normal() turns it back as far as the mirror image of the view needs to stay
//   above the surface, as Cycles does (ensure_valid_specular_reflection), here in closed form.
// - Towards the light, terminator_shadowing() fades what the turned normal sees from behind the smooth
//   surface (Chiang, Li, Burley 2019, "Taming the Shadow Terminator"). It is at most 1 and part of the BSDF:
//   values and throughputs are multiplied by it, densities are not, so MIS stays consistent and energy can
//   only be lost.
#pragma once

#include <memory>

#include "runtime/tracer/height_map.h"
#include "runtime/tracer/tangents.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {

struct Relief {
  std::shared_ptr<const HeightMap> map;
  Point2 tiles;       // copies of the map per unit of u and of v
  double height = 0;  // of the map's value 1, in units of |dp/du|: the length of a unit of u on the surface
  // This map stands in place of `map` where v >= 0, if given: one copy per unit of u and of v. It is that of
  // a snake's head.
  std::shared_ptr<const HeightMap> head = {};
};

// Returns the unit normal of the surface displaced by the relief along the unit `normal`, to first order in
// curvature (Blinn 1978; the surface gradient after Mikkelsen 2010). The height follows |dp/du| where it
// varies, so that scales keep their shape on a taper; its own derivative is left out. It is `normal` itself
// where `derivatives` span no area.
Vec3 relief_normal(const Relief& relief, const Point2& uv, const Vec3& normal,
                   const UvDerivatives& derivatives);

// Returns `normal`, turned towards `geometric` just far enough that reflect(wo, normal) has a cosine to
// `geometric` of at least min(0.9 dot(wo, geometric), 0.01). dot(wo, result) is then positive too. All are
// unit vectors, with dot(wo, geometric) > 0.
Vec3 valid_normal(const Vec3& normal, const Vec3& geometric, const Vec3& wo);

// Returns a factor in [0, 1]. It is 1 where `wi` is as high above the smooth surface as above the turned one,
// relative to the angle between the two normals; it falls to 0, with a slope of 1, at the horizon of the
// smooth surface.
double terminator_shadowing(const Vec3& normal, const Vec3& smooth_normal, const Vec3& wi);

}  // namespace sunbeam
