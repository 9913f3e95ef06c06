#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "runtime/tracer/gltf.h"
#include "runtime/tracer/mesh_file.h"
#include "runtime/tracer/obj.h"
#include "runtime/tracer/ply.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

// Height of the triangle over its longest edge, relative to that edge, must exceed float rounding.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({length(b - a), length(c - b), length(a - c)});
  return length(cross(b - a, c - a)) > 1e-7 * longest * longest;
}

// In single precision too, so that nothing that is computed from them overflows.
void require_finite(const std::string& path, const char* what, std::size_t index, const Vec3& v) {
  constexpr double kMost = std::numeric_limits<float>::max();
  if (!(std::abs(v.x) <= kMost && std::abs(v.y) <= kMost && std::abs(v.z) <= kMost))
    throw Error(fmt::format("{}: {} {} holds a number that is not finite", path, what, index));
}

Vec3 unit_normal(const std::string& path, std::size_t index, const Vec3& normal) {
  constexpr double kLeast = 1e-100, kMost = 1e100;  // whose squares are exact enough
  require_finite(path, "normal", index, normal);
  const double size = length(normal);
  if (!(size >= kLeast && size <= kMost))
    throw Error(fmt::format("{}: normal {} has length {:g}; allowed: {:g} to {:g}", path, index, size, kLeast,
                            kMost));
  return normalize(normal);
}

}  // namespace

LoadedMesh checked_mesh(const std::string& path, Mesh mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    require_finite(path, "position", i, mesh.positions[i]);
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
    require_finite(path, "texture coordinate", i, {mesh.uvs[i].x, mesh.uvs[i].y, 0});
  for (std::size_t i = 0; i < mesh.normals.size(); ++i)
    mesh.normals[i] = unit_normal(path, i, mesh.normals[i]);
  if (mesh.triangles.empty()) throw Error(path + ": the mesh has no face");
  const std::size_t dropped = std::erase_if(mesh.triangles, [&](const auto& t) {
    return !has_area(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
  });
  if (mesh.triangles.empty())
    throw Error(fmt::format("{}: found {} triangles without area and no other face", path, dropped));
  return {std::move(mesh), dropped};
}

std::uint32_t checked_index(const char* name, double index, std::uint64_t count) {
  if (!(index >= 0 && index < static_cast<double>(count) && index == std::floor(index)))
    throw Error(
        fmt::format("{} index {:g}; allowed: 0 to {}", name, index, static_cast<std::int64_t>(count) - 1));
  return static_cast<std::uint32_t>(index);
}

void require_mesh_memory(const std::string& path, std::uint64_t vertices, std::uint64_t triangles,
                         std::uint64_t file_bytes) {
  constexpr std::uint64_t kVertex = 2 * sizeof(Vec3) + sizeof(Point2), kTriangle = 3 * sizeof(std::uint32_t);
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  if (vertices > kMost)
    throw Error(fmt::format("{}: the mesh has {} vertices; allowed: up to {}", path, vertices, kMost));
  require_within_read_limit(
      fmt::format("{}: a mesh of {} vertices and {} triangles", path, vertices, triangles),
      kVertex * vertices + kTriangle * triangles, file_bytes);
}

LoadedMesh load_mesh(const std::string& path, const std::string& folder) {
  const std::string type = extension(path);
  if (type == ".obj") return load_obj(path);
  if (type == ".ply") return load_ply(path);
  if (type == ".gltf" || type == ".glb") return load_gltf(path, folder);
  throw Error(fmt::format("{}: extension is '{}'; allowed for a mesh: .obj, .ply, .gltf, .glb", path, type));
}

}  // namespace sunbeam
