#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <iterator>

#include "runtime/tracer/mesh_file.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

std::string obj_text(const Mesh& mesh) {
  std::string text;
  const auto out = std::back_inserter(text);
  const auto f = [](double x) { return static_cast<float>(x); };  // as in PLY
  for (const Vec3& p : mesh.positions) fmt::format_to(out, "v {} {} {}\n", f(p.x), f(p.y), f(p.z));
  for (const Point2& uv : mesh.uvs) fmt::format_to(out, "vt {} {}\n", f(uv.x), f(uv.y));
  for (const Vec3& n : mesh.normals) fmt::format_to(out, "vn {} {} {}\n", f(n.x), f(n.y), f(n.z));
  for (const auto& triangle : mesh.triangles) {
    text += 'f';
    for (const std::uint32_t corner : triangle) {
      const std::uint32_t i = corner + 1;
      fmt::format_to(out, " {}", i);
      if (!mesh.uvs.empty()) fmt::format_to(out, "/{}", i);
      if (!mesh.normals.empty()) fmt::format_to(out, "{}{}", mesh.uvs.empty() ? "//" : "/", i);
    }
    text += '\n';
  }
  return text;
}

template <class T>
void put(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

void put(std::string& bytes, std::initializer_list<double> values) {
  for (const double value : values) put(bytes, static_cast<float>(value));
}

std::string ply_bytes(const Mesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n",
      mesh.positions.size());
  if (!mesh.normals.empty()) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.uvs.empty()) bytes += "property float s\nproperty float t\n";
  bytes += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                       mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    put(bytes, {p.x, p.y, p.z});
    if (!mesh.normals.empty()) put(bytes, {mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z});
    if (!mesh.uvs.empty()) put(bytes, {mesh.uvs[i].x, mesh.uvs[i].y});
  }
  for (const auto& triangle : mesh.triangles) {
    put(bytes, static_cast<unsigned char>(3));
    for (const std::uint32_t corner : triangle) put(bytes, static_cast<std::int32_t>(corner));
  }
  return bytes;
}

}  // namespace

void require_mesh_extension(const std::string& path) {
  const std::string type = extension(path);
  if (type != ".obj" && type != ".ply")
    throw Error(fmt::format("{}: extension is '{}'; allowed for writing a mesh: .obj, .ply", path, type));
}

void write_mesh(const std::string& path, const Mesh& mesh) {
  require_mesh_extension(path);
  write_file_atomically(path, extension(path) == ".obj" ? obj_text(mesh) : ply_bytes(mesh));
}

}  // namespace sunbeam
