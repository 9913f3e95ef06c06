#include "runtime/tracer/obj.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string_view>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

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
    for (const List& list : lists_)
      if (list.largest > list.count)
        fail(list.largest_line,
             fmt::format("{} index {}; allowed: 1 to {}", list.name, list.largest, list.count));
  }

 private:
  // What faces point into.
  struct List {
    const char *keyword, *name;
    int numbers;  // in an entry
    long count = 0;
    long largest = 0, largest_line = 0;  // index, and where it stands
  };

  void check_line(const std::string& line) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    for (List& list : lists_)
      if (keyword == list.keyword) check_numbers(list, words), ++list.count;
    if (keyword == "f") check_face(words);
  }

  void check_numbers(const List& list, std::istringstream& words) {
    for (int i = 0; i < list.numbers; ++i) {
      std::string word;
      words >> word;
      const char* begin = word.c_str() + (word.starts_with('+') ? 1 : 0);
      const char* end = word.c_str() + word.size();
      float value = 0;
      const auto parsed = std::from_chars(begin, end, value);
      if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value))
        fail(line_number_,
             fmt::format("'{}' entry {} is '{}'; allowed: a finite number", list.keyword, i + 1, word));
    }
  }

  void check_face(std::istringstream& words) {
    for (std::string word; words >> word;) {
      if (word.starts_with('#')) return;
      const char* field = word.c_str();
      for (List& list : lists_) {
        if (*field != '/') check_index(list, field, word);  // v//vn leaves vt out
        field = std::strchr(field, '/');
        if (!field) break;
        ++field;
      }
    }
  }

  void check_index(List& list, const char* field, const std::string& word) {
    const long index = std::strtol(field, nullptr, 10);
    if (index == 0 || index < -list.count)
      fail(line_number_,
           fmt::format("{} index '{}'; allowed: 1 up, or -1 down to -{}", list.name, word, list.count));
    if (index > list.largest) list.largest = index, list.largest_line = line_number_;
  }

  [[noreturn]] void fail(long line, const std::string& message) const {
    throw Error(fmt::format("{}:{}: {}", path_, line, message));
  }

  const std::string& path_;
  long line_number_ = 0;
  // In the order of the fields of a corner, v/vt/vn.
  std::array<List, 3> lists_{{{"v", "face", 3}, {"vt", "texture", 2}, {"vn", "normal", 3}}};
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

Point2 pair(const std::vector<tinyobj::real_t>& values, int index) {
  const tinyobj::real_t* v = &values[2 * static_cast<std::size_t>(index)];
  return {v[0], v[1]};
}

Vec3 normal_of(const std::string& path, const tinyobj::attrib_t& attributes, int index) {
  const Vec3 normal = triple(attributes.normals, index);
  if (!(length(normal) > 0)) throw Error(fmt::format("{}: normal {} has length 0", path, index + 1));
  return normalize(normal);
}

}  // namespace

LoadedMesh load_obj(const std::string& path) {
  const std::string text = read_file(path);
  ObjCheck(path).check(text);
  const ObjData data = parse(path, text);

  Mesh mesh;
  bool has_normals = true, has_uvs = true;
  for (const auto& shape : data.shapes)
    for (const auto& corner : shape.mesh.indices) {
      mesh.positions.push_back(triple(data.attributes.vertices, corner.vertex_index));
      has_normals = has_normals && corner.normal_index >= 0;
      if (has_normals) mesh.normals.push_back(normal_of(path, data.attributes, corner.normal_index));
      has_uvs = has_uvs && corner.texcoord_index >= 0;
      if (has_uvs) mesh.uvs.push_back(pair(data.attributes.texcoords, corner.texcoord_index));
    }
  if (!has_normals) mesh.normals.clear();  // smooth shading needs all of them
  if (!has_uvs) mesh.uvs.clear();
  for (std::uint32_t i = 0; i + 2 < mesh.positions.size(); i += 3)
    mesh.triangles.push_back({i, i + 1, i + 2});
  return checked_mesh(path, std::move(mesh));
}

}  // namespace sunbeam
