// This file holds triangle meshes in world space, and makes them of shapes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sunbeam/core/vec.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // unit, one per position; empty: the triangles are flat
  // These are texture coordinates, one per position, or none. Vertices must be doubled where u or v jumps or
  // mirrors.
  std::vector<Point2> uvs;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Returns the parallelogram corner + s * edge_u + t * edge_v, s and t in [0, 1], which are its (u, v); its
// winding normal is along cross(edge_u, edge_v).
Mesh quad_mesh(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v);

// Returns a torus about the z axis, then turned by `rotate_deg` about x, then y, then z, then moved to
// `center`. It has `resolution` segments around the axis and half as many around the tube, and exact normals
// at the vertices. u runs around the axis and v around the tube, each from 0 to 1; at phi = 0 and psi = 0,
// where they start again, vertices are doubled.
Mesh torus_mesh(const Vec3& center, double major_radius, double minor_radius, const Vec3& rotate_deg,
                int resolution);

// Returns a sphere about the origin, with `resolution` segments around z and half as many from pole to pole,
// and exact normals. u is the longitude and v the latitude, each from 0 to 1; vertices are doubled where u
// starts again and at the poles.
Mesh sphere_mesh(double radius, int resolution);

// Takes v to scale * R v + translate, R turning about x, then y, then z.
struct Transform {
  double scale = 1;
  Vec3 rotate_deg = {};
  Vec3 translate = {};
};
Mesh transformed(Mesh mesh, const Transform& transform);

// Adds two triangles for each cell of a grid of (columns + 1) x (rows + 1) vertices, stored column by column.
// It is one where a cell has only three corners, because its first or last column or row lies in one point.
// Column by row is the winding's order.
void connect_grid(Mesh& mesh, std::uint32_t columns, std::uint32_t rows);

}  // namespace sunbeam
