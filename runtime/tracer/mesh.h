// Triangle meshes in world space, and the shapes that become one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sunbeam/core/vec.h"
#include "sunbeam/core/warp.h"

namespace sunbeam {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // unit, one per position; empty: the triangles are flat
  // Texture coordinates, one per position, or empty. Vertices must be doubled where u or v jumps or mirrors.
  std::vector<Point2> uvs;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// The parallelogram corner + s * edge_u + t * edge_v, s and t in [0, 1], which are its (u, v); its winding
// normal is along cross(edge_u, edge_v).
Mesh quad_mesh(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v);

// A torus about the z axis, then turned by `rotate_deg` about x, then y, then z, then moved to `center`.
// `resolution` segments around the axis and half as many around the tube; exact normals at the vertices.
// u runs around the axis and v around the tube, each from 0 to 1; at phi = 0 and psi = 0, where they start
// again, vertices are doubled.
Mesh torus_mesh(const Vec3& center, double major_radius, double minor_radius, const Vec3& rotate_deg,
                int resolution);

}  // namespace sunbeam
