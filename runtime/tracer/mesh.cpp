#include "runtime/tracer/mesh.h"

namespace sunbeam {
namespace {

Vec3 rotate_xyz(const Vec3& v, const Vec3& degrees) {
  const Vec3 angle = degrees * (kPi / 180);
  const double cx = std::cos(angle.x), sx = std::sin(angle.x);
  const double cy = std::cos(angle.y), sy = std::sin(angle.y);
  const double cz = std::cos(angle.z), sz = std::sin(angle.z);
  const Vec3 about_x = {v.x, cx * v.y - sx * v.z, sx * v.y + cx * v.z};
  const Vec3 about_y = {cy * about_x.x + sy * about_x.z, about_x.y, cy * about_x.z - sy * about_x.x};
  return {cz * about_y.x - sz * about_y.y, sz * about_y.x + cz * about_y.y, about_y.z};
}

bool is_same_point(const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
  if (!is_same_point(p, q) && !is_same_point(q, r) && !is_same_point(r, p))
    mesh.triangles.push_back({a, b, c});
}

}  // namespace

void connect_grid(Mesh& mesh, std::uint32_t columns, std::uint32_t rows) {
  for (std::uint32_t i = 0; i < columns; ++i)
    for (std::uint32_t j = 0; j < rows; ++j) {
      const std::uint32_t a = i * (rows + 1) + j, b = a + rows + 1, c = b + 1, d = a + 1;
      add_triangle(mesh, a, b, c);
      add_triangle(mesh, a, c, d);
    }
}

Mesh quad_mesh(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v) {
  Mesh mesh;
  mesh.positions = {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh torus_mesh(const Vec3& center, double major_radius, double minor_radius, const Vec3& rotate_deg,
                int resolution) {
  Mesh mesh;
  const int around_tube = resolution / 2;
  for (int i = 0; i <= resolution; ++i)
    for (int j = 0; j <= around_tube; ++j) {
      // The remainders put both sides of a seam at exactly the same place.
      const double phi = 2 * kPi * (i % resolution) / resolution;
      const double psi = 2 * kPi * (j % around_tube) / around_tube;
      const Vec3 outward = {std::cos(phi), std::sin(phi), 0};
      const Vec3 normal = outward * std::cos(psi) + Vec3{0, 0, std::sin(psi)};
      const Vec3 position = outward * major_radius + normal * minor_radius;
      mesh.positions.push_back(center + rotate_xyz(position, rotate_deg));
      mesh.normals.push_back(rotate_xyz(normal, rotate_deg));
      mesh.uvs.push_back({static_cast<double>(i) / resolution, static_cast<double>(j) / around_tube});
    }
  connect_grid(mesh, static_cast<std::uint32_t>(resolution), static_cast<std::uint32_t>(around_tube));
  return mesh;
}

Mesh sphere_mesh(double radius, int resolution) {
  Mesh mesh;
  const int rows = resolution / 2;
  for (int i = 0; i <= resolution; ++i)
    for (int j = 0; j <= rows; ++j) {
      // The remainder puts both sides of the seam, the ends all copies of a pole, at exactly the same place.
      const double phi = 2 * kPi * (i % resolution) / resolution;
      const double theta = kPi * (rows - j) / rows;
      const bool is_pole = j == 0 || j == rows;
      const Vec3 normal = is_pole ? Vec3{0, 0, j == 0 ? -1.0 : 1.0} : spherical_direction(theta, phi);
      mesh.positions.push_back(radius * normal);
      mesh.normals.push_back(normal);
      mesh.uvs.push_back({static_cast<double>(i) / resolution, static_cast<double>(j) / rows});
    }
  connect_grid(mesh, static_cast<std::uint32_t>(resolution), static_cast<std::uint32_t>(rows));
  return mesh;
}

Vec3 Transform::direction(const Vec3& d) const { return rotate_xyz(d, rotate_deg); }
Vec3 Transform::point(const Vec3& p) const { return scale * direction(p) + translate; }

Mesh transformed(Mesh mesh, const Transform& transform) {
  for (Vec3& position : mesh.positions) position = transform.point(position);
  for (Vec3& normal : mesh.normals) normal = transform.direction(normal);
  return mesh;
}

}  // namespace sunbeam
