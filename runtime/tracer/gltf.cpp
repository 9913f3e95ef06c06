#include "runtime/tracer/gltf.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

using Json = nlohmann::json;

std::uint32_t word(const std::string& bytes, std::size_t at) {
  if (at + 4 > bytes.size()) throw Error("ends too early");
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::string from_base64(std::string_view text) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const auto digit = kDigits.find(c);
    if (digit == std::string_view::npos) throw Error("a buffer's base64 text has a wrong letter");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
  }
  return bytes;
}

// A column-major 4 x 4 matrix of glTF, without its last row: x -> linear x + offset.
struct Affine {
  std::array<Vec3, 3> columns = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 offset = {};

  Vec3 linear(const Vec3& v) const { return v.x * columns[0] + v.y * columns[1] + v.z * columns[2]; }
  Vec3 point(const Vec3& p) const { return linear(p) + offset; }
  double determinant() const { return dot(columns[0], cross(columns[1], columns[2])); }
  // By the cofactors, which are the inverse transpose up to a factor; turned back where the matrix mirrors.
  Vec3 normal(const Vec3& n) const {
    const Vec3 turned = n.x * cross(columns[1], columns[2]) + n.y * cross(columns[2], columns[0]) +
                        n.z * cross(columns[0], columns[1]);
    return determinant() < 0 ? -turned : turned;
  }
  Affine operator*(const Affine& inner) const {
    return {{linear(inner.columns[0]), linear(inner.columns[1]), linear(inner.columns[2])},
            point(inner.offset)};
  }
};

std::vector<double> numbers(const Json& node, const char* key, std::size_t count) {
  const auto values = node.at(key).get<std::vector<double>>();
  if (values.size() != count)
    throw Error(fmt::format("{} has {} numbers; allowed: {}", key, values.size(), count));
  return values;
}

Affine rotation(double x, double y, double z, double w) {
  return {{Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
           Vec3{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
           Vec3{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}}};
}

Affine matrix_of(const Json& node) {
  Affine result;
  if (node.contains("matrix")) {
    const auto m = numbers(node, "matrix", 16);
    return {{Vec3{m[0], m[1], m[2]}, Vec3{m[4], m[5], m[6]}, Vec3{m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
  }
  if (node.contains("rotation")) {
    const auto q = numbers(node, "rotation", 4);
    result = rotation(q[0], q[1], q[2], q[3]);
  }
  if (node.contains("scale")) {
    const auto s = numbers(node, "scale", 3);
    for (std::size_t i = 0; i < 3; ++i) result.columns[i] = s[i] * result.columns[i];
  }
  if (node.contains("translation")) {
    const auto t = numbers(node, "translation", 3);
    result.offset = {t[0], t[1], t[2]};
  }
  return result;
}

class Document {
 public:
  explicit Document(const std::string& path) : folder_(std::filesystem::path(path).parent_path()) {
    const std::string bytes = read_file(path);
    if (bytes.starts_with("glTF"))
      split_glb(bytes);
    else
      json_ = Json::parse(bytes);
    if (json_.at("asset").at("version").get<std::string>().substr(0, 2) != "2.")
      throw Error("is not of version 2");
    if (json_.contains("buffers"))
      for (const Json& buffer : json_["buffers"]) buffers_.push_back(read_buffer(buffer));
  }

  Mesh mesh() {
    for (const std::size_t root : roots()) add_node(root, {}, 0);
    if (!has_normals_) mesh_.normals.clear();
    if (!has_uvs_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  void split_glb(const std::string& bytes) {
    constexpr std::uint32_t kJson = 0x4e4f534a;
    const std::size_t json_size = word(bytes, 12);
    if (word(bytes, 4) != 2 || word(bytes, 16) != kJson || word(bytes, 8) > bytes.size() ||
        20 + json_size > bytes.size())
      throw Error("its header is damaged or the file is cut short");
    json_ = Json::parse(bytes.substr(20, json_size));
    const std::size_t binary = 20 + json_size;
    if (binary == bytes.size()) return;
    const std::size_t size = word(bytes, binary);
    if (binary + 8 + size > bytes.size()) throw Error("the file is cut short");
    binary_ = bytes.substr(binary + 8, size);
  }

  std::string read_buffer(const Json& buffer) const {
    std::string bytes = binary_;
    if (buffer.contains("uri")) {
      const auto uri = buffer["uri"].get<std::string>();
      const auto comma = uri.find(";base64,");
      if (uri.starts_with("data:") && comma == std::string::npos) throw Error("a data URI is not base64");
      bytes = uri.starts_with("data:") ? from_base64(std::string_view(uri).substr(comma + 8))
                                       : read_file((folder_ / uri).string());
    }
    if (buffer.at("byteLength").get<std::size_t>() > bytes.size())
      throw Error(fmt::format("a buffer has {} bytes, fewer than byteLength says", bytes.size()));
    return bytes;
  }

  const Json& entry(const char* list, std::size_t index) const {
    const Json& entries = json_.at(list);
    if (index >= entries.size())
      throw Error(
          fmt::format("{} index {}; allowed: 0 to {}", list, index, static_cast<long>(entries.size()) - 1));
    return entries[index];
  }

  std::vector<std::size_t> roots() const {
    if (json_.contains("scenes")) {
      const Json& scene = entry("scenes", json_.value("scene", std::size_t{0}));
      return scene.value("nodes", std::vector<std::size_t>{});
    }
    std::vector<std::size_t> all;
    for (std::size_t i = 0; json_.contains("nodes") && i < json_["nodes"].size(); ++i) all.push_back(i);
    for (const std::size_t parent : std::vector<std::size_t>(all))
      for (const std::size_t child : entry("nodes", parent).value("children", std::vector<std::size_t>{}))
        std::erase(all, child);
    return all;
  }

  void add_node(std::size_t index, const Affine& parent, int depth) {
    constexpr int kMaxDepth = 1000;  // the stack bears far more
    if (depth > kMaxDepth) throw Error(fmt::format("nodes are nested deeper than {}", kMaxDepth));
    const Json& node = entry("nodes", index);
    if (visited_.size() <= index) visited_.resize(index + 1);
    if (visited_[index]) throw Error(fmt::format("node {} is met twice; nodes must form trees", index));
    visited_[index] = true;
    const Affine matrix = parent * matrix_of(node);
    if (node.contains("mesh"))
      for (const Json& primitive : entry("meshes", node["mesh"].get<std::size_t>()).at("primitives"))
        add_primitive(primitive, matrix);
    for (const std::size_t child : node.value("children", std::vector<std::size_t>{}))
      add_node(child, matrix, depth + 1);
  }

  void add_primitive(const Json& primitive, const Affine& matrix) {
    constexpr int kTriangles = 4;
    const int mode = primitive.value("mode", kTriangles);
    if (mode < kTriangles) return;  // points and lines
    if (mode > kTriangles) throw Error(fmt::format("found mode {}; allowed: 4, triangles", mode));
    if (primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression"))
      throw Error("is compressed (KHR_draco_mesh_compression); allowed: plain meshes");
    const Json& attributes = primitive.at("attributes");
    const auto positions = values(attributes.at("POSITION").get<std::size_t>(), 3);
    const auto optional = [&](const char* name, std::size_t components) {
      auto found = attributes.contains(name) ? values(attributes[name].get<std::size_t>(), components)
                                             : std::vector<double>();
      if (!found.empty() && found.size() / components != positions.size() / 3)
        throw Error(fmt::format("{} and POSITION have different counts", name));
      return found;
    };
    const auto normals = optional("NORMAL", 3), uvs = optional("TEXCOORD_0", 2);
    has_normals_ = has_normals_ && !normals.empty();
    has_uvs_ = has_uvs_ && !uvs.empty();
    const std::size_t first = mesh_.positions.size(), count = positions.size() / 3;
    const auto triple = [](const std::vector<double>& v, std::size_t i) {
      return Vec3{v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    };
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.positions.push_back(matrix.point(triple(positions, i)));
      if (has_normals_) mesh_.normals.push_back(matrix.normal(triple(normals, i)));
      if (has_uvs_) mesh_.uvs.push_back({uvs[2 * i], 1 - uvs[2 * i + 1]});  // glTF's v points down
    }
    add_triangles(primitive, first, count, matrix.determinant() < 0);
  }

  void add_triangles(const Json& primitive, std::size_t first, std::size_t count, bool mirrored) {
    std::vector<double> indices;
    if (primitive.contains("indices"))
      indices = values(primitive["indices"].get<std::size_t>(), 1);
    else
      for (std::size_t i = 0; i < count; ++i) indices.push_back(static_cast<double>(i));
    for (const double index : indices)
      if (!(index >= 0 && index < static_cast<double>(count)))
        throw Error(fmt::format("face index {:g}; allowed: 0 to {}", index, static_cast<long>(count) - 1));
    const auto corner = [&](std::size_t i) {
      return static_cast<std::uint32_t>(first + static_cast<std::size_t>(indices[i]));
    };
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      mesh_.triangles.push_back({corner(i), corner(i + 1), corner(i + 2)});
      if (mirrored) std::swap(mesh_.triangles.back()[1], mesh_.triangles.back()[2]);
    }
  }

  // All numbers of an accessor of `components` to an entry.
  std::vector<double> values(std::size_t index, std::size_t components) const {
    static constexpr std::array<const char*, 4> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const Json& accessor = entry("accessors", index);
    if (accessor.at("type").get<std::string>() != kTypes[components - 1])
      throw Error(fmt::format("accessor {} has the type {}; allowed: {}", index,
                              accessor.at("type").get<std::string>(), kTypes[components - 1]));
    if (accessor.contains("sparse") || !accessor.contains("bufferView"))
      throw Error(fmt::format("accessor {} is sparse or has no data; allowed: plain ones", index));
    const Json& view = entry("bufferViews", accessor["bufferView"].get<std::size_t>());
    const auto buffer = view.at("buffer").get<std::size_t>();
    if (buffer >= buffers_.size()) throw Error(fmt::format("buffer index {} is out of range", buffer));
    const int type = accessor.at("componentType").get<int>();
    const std::size_t size = component_size(type) * components;
    const auto stride = view.value("byteStride", size), count = accessor.at("count").get<std::size_t>();
    const auto view_size = view.at("byteLength").get<std::size_t>(),
               view_at = view.value("byteOffset", std::size_t{0});
    const auto at = accessor.value("byteOffset", std::size_t{0});
    constexpr std::size_t kMost = std::size_t{1} << 40;  // no sum or product below overflows
    if (count > kMost || stride < size || stride > 252 || at > kMost || view_size > kMost ||
        view_at > kMost || view_at + view_size > buffers_[buffer].size() ||
        (count > 0 && at + (count - 1) * stride + size > view_size))
      throw Error(fmt::format("accessor {} reaches beyond its buffer", index));
    std::vector<double> result;
    const bool normalized = accessor.value("normalized", false);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < components; ++k)
        result.push_back(
            component(buffers_[buffer].data() + view_at + at + i * stride + k * component_size(type), type,
                      normalized));
    return result;
  }

  static std::size_t component_size(int type) {
    switch (type) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        throw Error(fmt::format("found componentType {}; allowed: 5120 to 5123, 5125, 5126", type));
    }
  }

  template <class T>
  static double integer(const char* bytes, bool normalized) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return normalized ? std::max(-1.0, static_cast<double>(value) /
                                           static_cast<double>(std::numeric_limits<T>::max()))
                      : static_cast<double>(value);
  }
  static double component(const char* bytes, int type, bool normalized) {
    switch (type) {
      case 5120:
        return integer<std::int8_t>(bytes, normalized);
      case 5121:
        return integer<std::uint8_t>(bytes, normalized);
      case 5122:
        return integer<std::int16_t>(bytes, normalized);
      case 5123:
        return integer<std::uint16_t>(bytes, normalized);
      case 5125:
        return integer<std::uint32_t>(bytes, normalized);
      default:
        return integer<float>(bytes, false);
    }
  }

  std::filesystem::path folder_;
  Json json_;
  std::string binary_;  // of a .glb
  std::vector<std::string> buffers_;
  std::vector<bool> visited_;
  bool has_normals_ = true, has_uvs_ = true;
  Mesh mesh_;
};

}  // namespace

LoadedMesh load_gltf(const std::string& path) {
  try {
    return checked_mesh(path, Document(path).mesh());
  } catch (const std::exception& error) {  // of the JSON library too
    const std::string message = error.what();
    throw Error(message.starts_with(path) ? message : path + ": not a valid glTF file: " + message);
  }
}

}  // namespace sunbeam
