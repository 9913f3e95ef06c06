// This file checks meshes that a reader returned.
#pragma once

#include <cmath>
#include <cstdlib>

#include "runtime/tracer/mesh_file.h"

namespace sunbeam::test {

inline bool is_finite(const Vec3& v) {
  return std::isfinite(static_cast<float>(v.x)) && std::isfinite(static_cast<float>(v.y)) &&
         std::isfinite(static_cast<float>(v.z));
}

// Aborts unless every index has its vertex, every number is finite and every normal has length 1.
inline void require_sound(const LoadedMesh& loaded) {
  const Mesh& mesh = loaded.mesh;
  const std::size_t count = mesh.positions.size();
  bool is_sound = !mesh.triangles.empty() && (mesh.normals.empty() || mesh.normals.size() == count) &&
                  (mesh.uvs.empty() || mesh.uvs.size() == count);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) is_sound = is_sound && corner < count;
  for (const Vec3& position : mesh.positions) is_sound = is_sound && is_finite(position);
  for (const Point2& uv : mesh.uvs) is_sound = is_sound && is_finite({uv.x, uv.y, 0});
  for (const Vec3& normal : mesh.normals) is_sound = is_sound && std::abs(length(normal) - 1) < 1e-9;
  if (!is_sound) std::abort();
}

}  // namespace sunbeam::test
