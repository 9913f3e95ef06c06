// This frame takes world directions to the local ones that BSDFs see: x = tangent, y = bitangent, z = shading
// normal. The tracer lays x along the direction of increasing u of the texture coordinates.
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

struct Frame {
  Vec3 tangent, bitangent, normal;

  // Returns some right-handed frame around a unit `n` (Duff et al. 2017, "Building an Orthonormal Basis,
  // Revisited").
  static Frame from_normal(const Vec3& n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    const double b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }

  // Returns the right-handed frame around a unit `n` whose x axis is `t` projected into the tangent plane.
  // `t` may have any length; if it is zero, not finite or parallel to `n`, this is from_normal(n).
  static Frame from_normal_and_tangent(const Vec3& n, const Vec3& t) {
    const Vec3 projected = t - dot(t, n) * n;
    const double size2 = dot(projected, projected);
    if (!(size2 > 1e-12 * dot(t, t))) return from_normal(n);
    const Vec3 tangent = projected / std::sqrt(size2);
    return {tangent, cross(n, tangent), n};
  }

  Vec3 to_local(const Vec3& world) const {
    return {dot(world, tangent), dot(world, bitangent), dot(world, normal)};
  }
  Vec3 to_world(const Vec3& local) const {
    return local.x * tangent + local.y * bitangent + local.z * normal;
  }
};

}  // namespace v1
}  // namespace sunbeam
