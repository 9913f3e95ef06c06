#include "runtime/tracer/obj.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <charconv>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "sunbeam/core/error.h"
#include "sunbeam/core/file.h"

namespace sunbeam {
namespace {

// The loader reads a number it does not understand (nan, inf, letters) as 0 and drops faces with bad indices,
// both in silence. This pass over the text refuses them first.
class ObjCheck {
 public:
  explicit ObjCheck(const std::string& path) : path_(path) {}

  void check(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      ++line_number_;
      check_line(line);
    }
    if (largest_index_ > vertices_)
      fail(largest_index_line_, fmt::format("face index {}; allowed: 1 to {}", largest_index_, vertices_));
  }

 private:
  void check_line(const std::string& line) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v" || keyword == "vn") check_numbers(keyword, words);
    if (keyword == "v") ++vertices_;
    if (keyword == "f") check_face(words);
  }

  void check_numbers(const std::string& keyword, std::istringstream& words) {
    for (int i = 0; i < 3; ++i) {
      std::string word;
      words >> word;
      const char* begin = word.c_str() + (word.starts_with('+') ? 1 : 0);
      const char* end = word.c_str() + word.size();
      float value = 0;
      const auto parsed = std::from_chars(begin, end, value);
      if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value))
        fail(line_number_,
             fmt::format("'{}' entry {} is '{}'; allowed: a finite number", keyword, i + 1, word));
    }
  }

  void check_face(std::istringstream& words) {
    for (std::string word; words >> word;) {
      if (word.starts_with('#')) return;
      const long index = std::strtol(word.c_str(), nullptr, 10);
      if (index == 0 || index < -vertices_)
        fail(line_number_, fmt::format("face index '{}'; allowed: 1 up, or -1 down to -{}", word, vertices_));
      if (index > largest_index_) largest_index_ = index, largest_index_line_ = line_number_;
    }
  }

  [[noreturn]] void fail(long line, const std::string& message) const {
    throw Error(fmt::format("{}:{}: {}", path_, line, message));
  }

  const std::string& path_;
  long line_number_ = 0, vertices_ = 0;
  long largest_index_ = 0, largest_index_line_ = 0;
};

struct ObjData {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
};

ObjData parse(const std::string& path, const std::string& text) {
  ObjData data;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  std::istringstream in(text);
  if (!tinyobj::LoadObj(&data.attributes, &data.shapes, &materials, &warning, &error, &in))
    throw Error(fmt::format("{}: not a valid OBJ file: {}", path, error.substr(0, error.find('\n'))));
  return data;
}

Vec3 triple(const std::vector<tinyobj::real_t>& values, int index) {
  const tinyobj::real_t* v = &values[3 * static_cast<std::size_t>(index)];
  return {v[0], v[1], v[2]};
}

Vec3 normal_of(const std::string& path, const tinyobj::attrib_t& attributes, int index) {
  if (3 * static_cast<std::size_t>(index) >= attributes.normals.size())
    throw Error(
        fmt::format("{}: normal index {}; allowed: 1 to {}", path, index + 1, attributes.normals.size() / 3));
  const Vec3 normal = triple(attributes.normals, index);
  if (!(length(normal) > 0)) throw Error(fmt::format("{}: normal {} has length 0", path, index + 1));
  return normalize(normal);
}

// Height of the triangle over its longest edge, relative to that edge, must exceed float rounding.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({length(b - a), length(c - b), length(a - c)});
  return length(cross(b - a, c - a)) > 1e-7 * longest * longest;
}

void require_areas(const std::string& path, const Mesh& mesh) {
  for (const auto& [a, b, c] : mesh.triangles)
    if (const Vec3& p = mesh.positions[a]; !has_area(p, mesh.positions[b], mesh.positions[c]))
      throw Error(fmt::format("{}: triangle without area at ({:g}, {:g}, {:g}) after scale and translate",
                              path, p.x, p.y, p.z));
}

}  // namespace

Mesh load_obj(const std::string& path, double scale, const Vec3& translate) {
  const std::string text = read_file(path);
  ObjCheck(path).check(text);
  const ObjData data = parse(path, text);

  Mesh mesh;
  bool has_normals = true;
  for (const auto& shape : data.shapes)
    for (const auto& corner : shape.mesh.indices) {
      mesh.positions.push_back(scale * triple(data.attributes.vertices, corner.vertex_index) + translate);
      has_normals = has_normals && corner.normal_index >= 0;
      if (has_normals) mesh.normals.push_back(normal_of(path, data.attributes, corner.normal_index));
    }
  if (!has_normals) mesh.normals.clear();  // smooth shading needs all of them
  for (std::uint32_t i = 0; i + 2 < mesh.positions.size(); i += 3)
    mesh.triangles.push_back({i, i + 1, i + 2});
  if (mesh.triangles.empty()) throw Error(path + ": the mesh has no face");
  require_areas(path, mesh);
  return mesh;
}

}  // namespace sunbeam
