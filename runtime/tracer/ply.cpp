#include "runtime/tracer/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "runtime/tracer/ply_header.h"
#include "runtime/tracer/polygon.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& path)
      : path_(path),
        file_bytes_(bytes.size()),
        header_(read_ply_header(bytes)),
        numbers_(bytes.substr(header_.size), header_.format) {
    const PlyElement* vertices = header_.element("vertex");
    vertex_count_ = vertices ? vertices->count : 0;
    header_.element("face"), header_.element("tristrips");  // once each
  }

  Mesh mesh() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else if (element.name == "tristrips")
        read_strips(element);
      else
        read_ply_rows(
            numbers_, element, [](auto...) {}, [](auto&) {});
    }
    split_corners();
    require_memory();
    cut_faces();
    add_strips();
    return std::move(mesh_);
  }

 private:
  using Row = std::vector<double>;

  void read_vertices(const PlyElement& element) {
    const auto position = element.places({"x", "y", "z"}), normal = element.places({"nx", "ny", "nz"});
    std::vector<std::size_t> uv;
    for (const auto& names : {std::vector<std::string>{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}})
      if (uv.empty()) uv = element.places(names);
    if (position.empty()) throw Error("its vertices have no x, y, z");
    numbers_.require_rows(element);
    require_mesh_memory(path_, element.count, 0, file_bytes_);
    mesh_.positions.reserve(element.count);
    if (!normal.empty()) mesh_.normals.reserve(element.count);
    if (!uv.empty()) mesh_.uvs.reserve(element.count);
    read_ply_rows(
        numbers_, element, [](auto...) {},
        [&](const Row& row) {
          const auto vec = [&](const auto& at) { return Vec3{row[at[0]], row[at[1]], row[at[2]]}; };
          mesh_.positions.push_back(vec(position));
          if (!normal.empty()) mesh_.normals.push_back(vec(normal));
          if (!uv.empty()) mesh_.uvs.push_back({row[uv[0]], row[uv[1]]});
        });
  }

  // Indices of faces are held against the header, for vertices may come after faces.
  std::uint32_t vertex_of(double index) const { return checked_index("face", index, vertex_count_); }

  static std::size_t indices_of(const PlyElement& element) {
    const auto place = element.list({"vertex_indices", "vertex_index"});
    if (!place) throw Error(fmt::format("found the element {} without a list vertex_indices", element.name));
    return *place;
  }

  void read_faces(const PlyElement& element) {
    if (element.count == 0) return;
    const std::size_t indices = indices_of(element);
    const auto uvs = element.list({"texcoord"});
    std::size_t uv_count = 0;
    read_ply_rows(
        numbers_, element,
        [&](std::size_t place, const Row& entries) {
          if (place == indices)
            for (const double index : entries) corners_.push_back(vertex_of(index));
          if (place != uvs) return;
          for (std::size_t k = 0; k + 1 < entries.size(); k += 2)
            corner_uvs_.push_back({entries[k], entries[k + 1]});
          uv_count = entries.size();
        },
        [&](const Row&) {
          const std::size_t first = face_ends_.empty() ? 0 : face_ends_.back(),
                            size = corners_.size() - first;
          if (uvs && uv_count != 0 && uv_count != 2 * size)
            throw Error(
                fmt::format("found a face of {} corners with {} numbers in texcoord; allowed: 0 or {}", size,
                            uv_count, 2 * size));
          face_ends_.push_back(corners_.size());
        });
  }

  void read_strips(const PlyElement& element) {
    if (element.count == 0) return;
    const std::size_t indices = indices_of(element);
    read_ply_rows(
        numbers_, element,
        [&](std::size_t place, const Row& entries) {
          if (place != indices) return;
          for (const double index : entries) strips_.push_back(index == -1 ? kRestart : vertex_of(index));
          strips_.push_back(kRestart);
        },
        [](const Row&) {});
  }

  // Texture coordinates at corners make each corner a vertex of its own. Strips have none.
  void split_corners() {
    if (!strips_.empty() || corner_uvs_.empty() || corner_uvs_.size() != corners_.size()) return;
    require_mesh_memory(path_, vertex_count_ + corners_.size(), 0, file_bytes_);
    Mesh split;
    split.uvs = std::move(corner_uvs_);
    split.positions.reserve(corners_.size());
    if (!mesh_.normals.empty()) split.normals.reserve(corners_.size());
    for (std::uint32_t& corner : corners_) {
      if (!mesh_.normals.empty()) split.normals.push_back(mesh_.normals[corner]);
      split.positions.push_back(mesh_.positions[corner]);
      corner = static_cast<std::uint32_t>(split.positions.size() - 1);
    }
    mesh_ = std::move(split);
  }

  void require_memory() {
    std::size_t triangles = strips_.size(), largest = 0, first = 0;
    for (const std::size_t end : face_ends_) {
      triangles += std::max(end - first, std::size_t{2}) - 2;
      largest = std::max(largest, end - first);
      first = end;
    }
    require_mesh_memory(path_, mesh_.positions.size(), triangles, file_bytes_);
    require_within_read_limit(fmt::format("{}: a face of {} corners", path_, largest),
                              PolygonCutter::kBytesPerCorner * largest, file_bytes_);
    mesh_.triangles.reserve(triangles);
  }

  void cut_faces() {
    PolygonCutter cutter;
    std::vector<Vec3> polygon;
    std::size_t first = 0;
    for (const std::size_t end : face_ends_) {
      polygon.clear();
      for (std::size_t i = first; i < end; ++i) polygon.push_back(mesh_.positions[corners_[i]]);
      for (const auto& [a, b, c] : cutter.cut(polygon))
        mesh_.triangles.push_back({corners_[first + a], corners_[first + b], corners_[first + c]});
      first = end;
    }
  }

  // Every second triangle of a strip is wound the other way. A repeated index only joins strips.
  void add_strips() {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < strips_.size(); ++i) {
      if (strips_[i] == kRestart) begin = i + 1;
      if (i < begin + 2) continue;
      const std::uint32_t a = strips_[i - 2], b = strips_[i - 1], c = strips_[i];
      if (a == b || b == c || c == a) continue;
      const bool is_turned = (i - begin) % 2 == 1;
      mesh_.triangles.push_back({is_turned ? b : a, is_turned ? a : b, c});
    }
  }

  static constexpr std::uint32_t kRestart = std::numeric_limits<std::uint32_t>::max();

  const std::string& path_;
  std::uint64_t file_bytes_;
  PlyHeader header_;
  PlyNumbers numbers_;
  std::uint64_t vertex_count_ = 0;
  std::vector<std::uint32_t> corners_;  // of all faces
  std::vector<std::size_t> face_ends_;  // in corners_
  std::vector<Point2> corner_uvs_;
  std::vector<std::uint32_t> strips_;  // all of them, each with kRestart behind it
  Mesh mesh_;
};

}  // namespace

LoadedMesh load_ply(const std::string& path) { return parse_ply(read_file(path), path); }

LoadedMesh parse_ply(std::string_view bytes, const std::string& path) {
  try {
    return checked_mesh(path, PlyReader(without_byte_order_mark(bytes), path).mesh());
  } catch (const Error& error) {
    const std::string message = error.what();
    throw Error(message.starts_with(path) ? message : path + ": not a valid PLY file: " + message);
  }
}

}  // namespace sunbeam
