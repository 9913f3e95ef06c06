#include "runtime/tracer/mesh.h"

namespace sunbeam {
namespace {

// About x, then y, then z.
class Rotation {
 public:
  explicit Rotation(const Vec3& degrees)
      : x_(degrees.x * (kPi / 180)), y_(degrees.y * (kPi / 180)), z_(degrees.z * (kPi / 180)) {}

  Vec3 operator()(const Vec3& v) const {
    const Vec3 about_x = {v.x, x_.cos * v.y - x_.sin * v.z, x_.sin * v.y + x_.cos * v.z};
    const Vec3 about_y = {y_.cos * about_x.x + y_.sin * about_x.z, about_x.y,
                          y_.cos * about_x.z - y_.sin * about_x.x};
    return {z_.cos * about_y.x - z_.sin * about_y.y, z_.sin * about_y.x + z_.cos * about_y.y, about_y.z};
  }

 private:
  struct Angle {
    explicit Angle(double angle) : cos(std::cos(angle)), sin(std::sin(angle)) {}
    double cos, sin;
  };
  Angle x_, y_, z_;
};

bool is_same_point(const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
  if (!is_same_point(p, q) && !is_same_point(q, r) && !is_same_point(r, p))
    mesh.triangles.push_back({a, b, c});
}

// Makes room for a grid as in connect_grid().
void reserve_grid(Mesh& mesh, int columns, int rows) {
  const std::size_t c = static_cast<std::size_t>(columns), r = static_cast<std::size_t>(rows);
  mesh.positions.reserve((c + 1) * (r + 1));
  mesh.normals.reserve((c + 1) * (r + 1));
  mesh.uvs.reserve((c + 1) * (r + 1));
  mesh.triangles.reserve(2 * c * r);
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
  const Rotation rotate(rotate_deg);
  reserve_grid(mesh, resolution, around_tube);
  for (int i = 0; i <= resolution; ++i) {
    // The remainders put both sides of a seam at exactly the same place.
    const double phi = 2 * kPi * (i % resolution) / resolution;
    const Vec3 outward = {std::cos(phi), std::sin(phi), 0};
    for (int j = 0; j <= around_tube; ++j) {
      const double psi = 2 * kPi * (j % around_tube) / around_tube;
      const Vec3 normal = outward * std::cos(psi) + Vec3{0, 0, std::sin(psi)};
      const Vec3 position = outward * major_radius + normal * minor_radius;
      mesh.positions.push_back(center + rotate(position));
      mesh.normals.push_back(rotate(normal));
      mesh.uvs.push_back({static_cast<double>(i) / resolution, static_cast<double>(j) / around_tube});
    }
  }
  connect_grid(mesh, static_cast<std::uint32_t>(resolution), static_cast<std::uint32_t>(around_tube));
  return mesh;
}

Mesh sphere_mesh(double radius, int resolution) {
  Mesh mesh;
  const int rows = resolution / 2;
  reserve_grid(mesh, resolution, rows);
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

Mesh transformed(Mesh mesh, const Transform& transform) {
  const Rotation rotate(transform.rotate_deg);
  for (Vec3& position : mesh.positions) position = transform.scale * rotate(position) + transform.translate;
  for (Vec3& normal : mesh.normals) normal = rotate(normal);
  return mesh;
}

}  // namespace sunbeam
