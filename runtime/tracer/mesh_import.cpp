#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <string_view>

#include "runtime/tracer/mesh_file.h"
#include "runtime/tracer/obj.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/file.h"

namespace sunbeam {
namespace {

// Height of the triangle over its longest edge, relative to that edge, must exceed float rounding.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({length(b - a), length(c - b), length(a - c)});
  return length(cross(b - a, c - a)) > 1e-7 * longest * longest;
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Vec3 to_vec(const aiVector3D& v) { return {v.x, v.y, v.z}; }

// What stands in an error, in one line.
std::string first_line(std::string_view text) { return std::string(text.substr(0, text.find('\n'))); }

class Collector {
 public:
  Collector(const std::string& path, const aiScene& scene) : path_(path) {
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
      has_normals_ = has_normals_ && scene.mMeshes[i]->HasNormals();
      has_uvs_ = has_uvs_ && scene.mMeshes[i]->HasTextureCoords(0);
    }
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) add(*scene.mMeshes[i]);
  }
  Mesh take() { return std::move(mesh_); }

 private:
  void add(const aiMesh& part) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      mesh_.positions.push_back(checked("position", i, to_vec(part.mVertices[i])));
      if (has_normals_) mesh_.normals.push_back(normal(i, to_vec(part.mNormals[i])));
      if (has_uvs_) {
        const Vec3 uv = checked("texture coordinate", i, to_vec(part.mTextureCoords[0][i]));
        mesh_.uvs.push_back({uv.x, uv.y});
      }
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) add_face(part, part.mFaces[i], first);
  }

  void add_face(const aiMesh& part, const aiFace& face, std::uint32_t first) {
    if (face.mNumIndices != 3) return;
    for (unsigned k = 0; k < 3; ++k)
      if (face.mIndices[k] >= part.mNumVertices)
        throw Error(fmt::format("{}: face index {}; allowed: 0 to {}", path_, face.mIndices[k],
                                static_cast<long>(part.mNumVertices) - 1));
    mesh_.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }

  Vec3 checked(const char* what, unsigned index, const Vec3& value) const {
    if (!is_finite(value))
      throw Error(fmt::format("{}: {} {} holds a number that is not finite", path_, what, index));
    return value;
  }
  Vec3 normal(unsigned index, const Vec3& value) const {
    if (!(length(checked("normal", index, value)) > 0))
      throw Error(fmt::format("{}: normal {} has length 0", path_, index));
    return normalize(value);
  }

  const std::string& path_;
  bool has_normals_ = true, has_uvs_ = true;
  Mesh mesh_;
};

LoadedMesh load_with_assimp(const std::string& path) {
  read_file(path);  // its error says why a file cannot be read
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(path, aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                                                     aiProcess_SortByPType | aiProcess_PreTransformVertices);
  if (!scene)
    throw Error(fmt::format("{}: not a valid mesh file: {}", path, first_line(importer.GetErrorString())));
  return without_flat_triangles(path, Collector(path, *scene).take());
}

}  // namespace

LoadedMesh without_flat_triangles(const std::string& path, Mesh mesh) {
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
  if (type == ".ply" || type == ".gltf" || type == ".glb") return load_with_assimp(path);
  throw Error(fmt::format("{}: extension is '{}'; allowed for a mesh: .obj, .ply, .gltf, .glb", path, type));
}

}  // namespace sunbeam
