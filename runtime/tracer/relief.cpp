#include "runtime/tracer/relief.h"

#include <cmath>

namespace sunbeam {

Vec3 relief_normal(const Relief& relief, const Point2& uv, const Vec3& normal,
                   const UvDerivatives& derivatives) {
  const Vec3 &du = derivatives.du, &dv = derivatives.dv;
  const double area = dot(normal, cross(du, dv));
  const double size2 = dot(du, du), other2 = dot(dv, dv);
  if (!(square(area) > 1e-8 * size2 * other2)) return normal;
  const bool is_head = relief.head && uv.y >= 0;
  const Point2 tiles = is_head ? Point2{1, 1} : relief.tiles;
  const HeightMap& map = is_head ? *relief.head : *relief.map;
  const Point2 slope = map.sample({uv.x * tiles.x, uv.y * tiles.y}).gradient;
  const double height = relief.height * std::sqrt(size2);
  const Vec3 gradient = (height * tiles.x * slope.x / area) * cross(dv, normal) +
                        (height * tiles.y * slope.y / area) * cross(normal, du);
  return normalize(normal - gradient);
}

Vec3 valid_normal(const Vec3& normal, const Vec3& geometric, const Vec3& wo) {
  const double above = dot(wo, geometric);
  const double least = std::min(0.9 * above, 0.01);
  if (dot(normal, geometric) > 0 && dot(reflect(wo, normal), geometric) >= least) return normal;
  const Vec3 sideways = normal - dot(normal, geometric) * geometric;
  const double size = length(sideways);
  if (!(size > 1e-12)) return geometric;
  // In the plane of the two normals, by angles from `geometric`: `wo` projected lies at `view` and has the
  // length `reach`; about a normal at x its mirror image lies at 2 x - view, with the height reach cos(2 x -
  // view).
  const Vec3 x_axis = sideways / size;
  const double across = dot(wo, x_axis);
  const double reach = std::hypot(across, above), view = std::atan2(across, above);
  const double farthest = 0.5 * (view + std::acos(std::min(least / reach, 1.0)));
  return std::cos(farthest) * geometric + std::sin(farthest) * x_axis;
}

double terminator_shadowing(const Vec3& normal, const Vec3& smooth_normal, const Vec3& wi) {
  const double seen = dot(normal, wi) * dot(normal, smooth_normal), there = dot(smooth_normal, wi);
  if (there <= 0 || seen <= 0) return 0;
  if (there >= seen) return 1;
  const double g = there / seen;
  return g * (1 + g * (1 - g));  // g + g^2 - g^3
}

}  // namespace sunbeam
