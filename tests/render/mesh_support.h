// What the tests of mesh files share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <string>

#include "runtime/tracer/mesh_file.h"
#include "tests/render/support.h"

namespace sunbeam {

inline Vec3 area_vector(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return 0.5 *
         cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
}

// The area of all triangles, whichever way they are wound.
inline double surface_area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& triangle : mesh.triangles) sum += length(area_vector(mesh, triangle));
  return sum;
}

// The area seen from +z, less that of triangles wound the other way: folds cancel.
inline double area_towards_z(const Mesh& mesh) {
  double sum = 0;
  for (const auto& triangle : mesh.triangles) sum += area_vector(mesh, triangle).z;
  return sum;
}

// Expects a plane mesh that covers `area` once.
inline void expect_covers(const Mesh& mesh, double area) {
  EXPECT_NEAR(surface_area(mesh), area, 1e-6 * area);
  EXPECT_NEAR(area_towards_z(mesh), area, 1e-6 * area);
}

inline Mesh mesh_from(const std::string& name, const std::string& content) {
  const ScratchFolder folder;
  return load_mesh(folder.write(name, content)).mesh;
}

// What is wrong with a file: one line that names it, "" if it loads.
inline std::string mesh_file_error(const std::string& name, const std::string& content) {
  const ScratchFolder folder;
  const std::string path = folder.write(name, content);
  const std::string message = error_of([&] { load_mesh(path); });
  EXPECT_TRUE(message.empty() || message.find(name) != std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  return message;
}

inline void expect_mesh_file_error(const std::string& name, const std::string& content,
                                   const std::string& part) {
  const std::string message = mesh_file_error(name, content);
  EXPECT_NE(message.find(part), std::string::npos) << message << "\n" << content.substr(0, 300);
}

template <class T>
void put(std::string& bytes, std::initializer_list<T> values) {
  for (const T value : values) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
  }
}

}  // namespace sunbeam
