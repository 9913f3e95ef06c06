#include <fmt/format.h>

#include <cmath>

#include "runtime/tracer/gltf.h"
#include "runtime/tracer/mesh_file.h"
#include "runtime/tracer/obj.h"
#include "runtime/tracer/ply.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

// Height of the triangle over its longest edge, relative to that edge, must exceed float rounding.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({length(b - a), length(c - b), length(a - c)});
  return length(cross(b - a, c - a)) > 1e-7 * longest * longest;
}

void require_finite(const std::string& path, const char* what, std::size_t index, const Vec3& v) {
  if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
    throw Error(fmt::format("{}: {} {} holds a number that is not finite", path, what, index));
}

}  // namespace

LoadedMesh checked_mesh(const std::string& path, Mesh mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    require_finite(path, "position", i, mesh.positions[i]);
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
    require_finite(path, "texture coordinate", i, {mesh.uvs[i].x, mesh.uvs[i].y, 0});
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    require_finite(path, "normal", i, mesh.normals[i]);
    if (!(length(mesh.normals[i]) > 0)) throw Error(fmt::format("{}: normal {} has length 0", path, i));
    mesh.normals[i] = normalize(mesh.normals[i]);
  }
  if (mesh.triangles.empty()) throw Error(path + ": the mesh has no face");
  const std::size_t dropped = std::erase_if(mesh.triangles, [&](const auto& t) {
    return !has_area(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
  });
  if (mesh.triangles.empty())
    throw Error(fmt::format("{}: found {} triangles without area and no other face", path, dropped));
  return {std::move(mesh), dropped};
}

LoadedMesh load_mesh(const std::string& path) {
  const std::string type = extension(path);
  if (type == ".obj") return load_obj(path);
  if (type == ".ply") return load_ply(path);
  if (type == ".gltf" || type == ".glb") return load_gltf(path);
  throw Error(fmt::format("{}: extension is '{}'; allowed for a mesh: .obj, .ply, .gltf, .glb", path, type));
}

}  // namespace sunbeam
