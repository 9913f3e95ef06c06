#include "runtime/tracer/gltf.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "runtime/tracer/affine.h"
#include "runtime/tracer/gltf_document.h"
#include "runtime/tracer/gltf_nodes.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

Vec3 triple(const std::vector<double>& v, std::size_t i) { return {v[3 * i], v[3 * i + 1], v[3 * i + 2]}; }

// The maps of the vertices of a primitive: one for all, or one for each.
class VertexMaps {
 public:
  explicit VertexMaps(std::vector<Affine> maps) : maps_(std::move(maps)) {
    for (const Affine& map : maps_) is_mirrored_.push_back(map.determinant() < 0);
  }
  const Affine& operator[](std::size_t vertex) const { return maps_[place(vertex)]; }
  bool is_mirrored(std::size_t vertex) const { return is_mirrored_[place(vertex)]; }

 private:
  std::size_t place(std::size_t vertex) const { return maps_.size() == 1 ? 0 : vertex; }

  std::vector<Affine> maps_;
  std::vector<bool> is_mirrored_;
};

class GltfReader {
 public:
  GltfReader(std::string_view bytes, const std::string& path, std::vector<std::string> folders)
      : path_(path), document_(bytes, std::move(folders)), nodes_(place_nodes(document_)) {}

  Mesh mesh() {
    for (const std::size_t index : nodes_.order) {
      const Json& node = document_.entry("nodes", index);
      if (!node.contains("mesh")) continue;
      const Json& mesh = document_.entry("meshes", node["mesh"]);
      const Json& weights = node.contains("weights") ? node : mesh;
      for (const Json& primitive : required(mesh, "primitives")) add_primitive(primitive, weights, index);
    }
    if (!has_normals_) mesh_.normals.clear();
    if (!has_uvs_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  enum Mode { kTriangles = 4, kStrip = 5, kFan = 6 };

  void add_primitive(const Json& primitive, const Json& weights, std::size_t node) {
    constexpr std::size_t kNumbersOfAny = 16;
    document_.count_numbers(kNumbersOfAny);
    const std::size_t mode = natural(primitive, "mode", kTriangles);
    if (mode < kTriangles) return;  // points and lines
    if (mode > kFan) throw Error(fmt::format("found mode {}; allowed: 0 to {}", mode, int{kFan}));
    if (primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression"))
      throw Error("is compressed (KHR_draco_mesh_compression); allowed: plain meshes");
    required(required(primitive, "attributes"), "POSITION");
    const auto positions = attribute(primitive, weights, "POSITION", "VEC3"),
               normals = attribute(primitive, weights, "NORMAL", "VEC3"),
               uvs = attribute(primitive, weights, "TEXCOORD_0", "VEC2");
    const std::size_t first = mesh_.positions.size(), count = positions.size() / 3;
    if ((!normals.empty() && normals.size() != 3 * count) || (!uvs.empty() && uvs.size() != 2 * count))
      throw Error("the attributes of a primitive have different counts");
    require_mesh_memory(path_, first + count, mesh_.triangles.size(), document_.file_bytes());
    has_normals_ = has_normals_ && normals.size() == 3 * count;
    has_uvs_ = has_uvs_ && uvs.size() == 2 * count;
    const VertexMaps maps = vertex_maps(primitive, node, count);
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.positions.push_back(maps[i].point(triple(positions, i)));
      if (has_normals_) mesh_.normals.push_back(mapped_normal(maps[i], triple(normals, i)));
      if (has_uvs_) mesh_.uvs.push_back({uvs[2 * i], 1 - uvs[2 * i + 1]});  // glTF's v points down
    }
    add_triangles(corners(primitive, count), mode, first, maps);
  }

  // Where a map is flat, triangles without area are left that need no normal.
  static Vec3 mapped_normal(const Affine& map, const Vec3& normal) {
    const Vec3 mapped = map.normal(normal);
    return map.determinant() == 0 && length(mapped) == 0 ? Vec3{0, 0, 1} : mapped;
  }

  // The numbers of an attribute, morph targets added; {} if the primitive has none.
  std::vector<double> attribute(const Json& primitive, const Json& weights, const char* name,
                                const char* type) {
    const Json& attributes = primitive["attributes"];
    if (!attributes.contains(name)) return {};
    std::vector<double> result = document_.values(attributes[name], type);
    if (!primitive.contains("targets") || !weights.contains("weights")) return result;
    const Json& targets = primitive["targets"];
    const auto target_weights = numbers(weights, "weights", targets.size());
    document_.count_numbers(targets.size());
    for (std::size_t k = 0; k < target_weights.size(); ++k) {
      if (target_weights[k] == 0 || !targets[k].contains(name)) continue;
      const std::vector<double> shift = document_.values(targets[k][name], type);
      if (shift.size() != result.size()) throw Error("a morph target has another count than its attribute");
      for (std::size_t i = 0; i < shift.size(); ++i) result[i] += target_weights[k] * shift[i];
    }
    return result;
  }

  // A skinned mesh follows its joints alone, whatever the matrix of its node.
  VertexMaps vertex_maps(const Json& primitive, std::size_t node, std::size_t count) {
    const Json& json = document_.entry("nodes", node);
    if (!json.contains("skin")) return VertexMaps({*nodes_.to_world[node]});
    const std::vector<Affine> joints = joint_maps(document_.entry("skins", json["skin"]));
    const Json& attributes = primitive["attributes"];
    std::vector<Affine> maps(count, Affine{{Vec3{}, Vec3{}, Vec3{}}, {}});
    std::vector<double> sums(count);
    for (int set = 0;; ++set) {
      const std::string joints_name = fmt::format("JOINTS_{}", set),
                        weights_name = fmt::format("WEIGHTS_{}", set);
      if (set > 0 && !attributes.contains(joints_name)) break;
      const auto places =
          document_.indices("joint", required(attributes, joints_name.c_str()), "VEC4", joints.size());
      const auto weights = document_.values(required(attributes, weights_name.c_str()), "VEC4");
      if (places.size() != 4 * count || weights.size() != 4 * count)
        throw Error(fmt::format("{} or {} has another count than POSITION", joints_name, weights_name));
      for (std::size_t i = 0; i < 4 * count; ++i) {
        if (weights[i] < 0)
          throw Error(fmt::format("found the joint weight {:g}; allowed: 0 up", weights[i]));
        maps[i / 4].add(weights[i], joints[places[i]]);
        sums[i / 4] += weights[i];
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!(sums[i] > 0))
        throw Error(fmt::format("the joint weights of vertex {} add up to {:g}", i, sums[i]));
      maps[i] = scaled(1 / sums[i], maps[i]);
    }
    return VertexMaps(std::move(maps));
  }

  static Affine scaled(double factor, const Affine& map) {
    Affine result{{Vec3{}, Vec3{}, Vec3{}}, {}};
    result.add(factor, map);
    return result;
  }

  std::vector<Affine> joint_maps(const Json& skin) {
    constexpr std::size_t kNumbersOfMap = 12;
    const auto joints = naturals(skin, "joints");
    document_.count_numbers(kNumbersOfMap * joints.size());
    std::vector<double> inverse;
    if (skin.contains("inverseBindMatrices")) {
      inverse = document_.values(skin["inverseBindMatrices"], "MAT4");
      if (inverse.size() < 16 * joints.size())
        throw Error(fmt::format("a skin has {} joints and {} inverse bind matrices", joints.size(),
                                inverse.size() / 16));
    }
    std::vector<Affine> maps;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      if (joints[k] >= nodes_.to_world.size() || !nodes_.to_world[joints[k]])
        throw Error(fmt::format("joint {} is no node of the scene", joints[k]));
      const Affine& to_world = *nodes_.to_world[joints[k]];
      maps.push_back(inverse.empty() ? to_world : to_world * affine_of(&inverse[16 * k]));
    }
    return maps;
  }

  std::vector<std::uint32_t> corners(const Json& primitive, std::size_t count) {
    if (primitive.contains("indices"))
      return document_.indices("face", primitive["indices"], "SCALAR", count);
    std::vector<std::uint32_t> all(count);
    for (std::size_t i = 0; i < count; ++i) all[i] = static_cast<std::uint32_t>(i);
    return all;
  }

  void add_triangles(const std::vector<std::uint32_t>& corners, std::size_t mode, std::size_t first,
                     const VertexMaps& maps) {
    const std::size_t step = mode == kTriangles ? 3 : 1;
    require_mesh_memory(path_, mesh_.positions.size(), mesh_.triangles.size() + corners.size() / step,
                        document_.file_bytes());
    const auto vertex = [&](std::uint32_t i) { return static_cast<std::uint32_t>(first + i); };
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      const bool is_odd = mode == kStrip && i % 2 == 1;
      const std::uint32_t a = corners[mode == kFan ? 0 : i], b = corners[i + (is_odd ? 2 : 1)],
                          c = corners[i + (is_odd ? 1 : 2)];
      if (mode != kTriangles && (a == b || b == c || c == a)) continue;  // joins strips
      const bool is_mirrored = maps.is_mirrored(a);
      mesh_.triangles.push_back({vertex(a), vertex(is_mirrored ? c : b), vertex(is_mirrored ? b : c)});
    }
  }

  const std::string& path_;
  GltfDocument document_;
  GltfNodes nodes_;
  bool has_normals_ = true, has_uvs_ = true;
  Mesh mesh_;
};

}  // namespace

LoadedMesh load_gltf(const std::string& path, const std::string& folder) {
  std::vector<std::string> folders = {std::filesystem::path(path).parent_path().string()};
  if (!folder.empty()) folders.push_back(folder);
  return parse_gltf(read_file(path), path, std::move(folders));
}

LoadedMesh parse_gltf(std::string_view bytes, const std::string& path, std::vector<std::string> folders) {
  try {
    return checked_mesh(path, GltfReader(bytes, path, std::move(folders)).mesh());
  } catch (const std::exception& error) {  // of the JSON library too
    const std::string message = error.what();
    throw Error(message.starts_with(path) ? message : path + ": not a valid glTF file: " + message);
  }
}

}  // namespace sunbeam
