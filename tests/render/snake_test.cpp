// The snake and the other shapes as meshes: closed, outward, with unit normals and continuous coordinates.
#include "runtime/tracer/snake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "runtime/tracer/tangents.h"

namespace sunbeam {
namespace {

using Place = std::tuple<double, double, double>;
Place place(const Vec3& p) { return {p.x, p.y, p.z}; }

// Vertices at the same place are one: every edge is then passed once in each direction.
void expect_closed(const Mesh& mesh) {
  std::map<std::pair<Place, Place>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[{place(mesh.positions[t[k]]), place(mesh.positions[t[(k + 1) % 3]])}];
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
  }
}

void expect_outward_unit_normals(const Mesh& mesh, double least_cosine) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const Vec3& normal : mesh.normals) ASSERT_NEAR(length(normal), 1, 1e-9);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 winding = cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    ASSERT_GT(length(winding), 0);
    for (const std::uint32_t corner : {a, b, c})
      ASSERT_GT(dot(normalize(winding), mesh.normals[corner]), least_cosine);
  }
}

double volume(const Mesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c]));
  return six / 6;
}

TEST(SphereMesh, IsAClosedSphere) {
  const Mesh mesh = sphere_mesh(2, 64);
  expect_closed(mesh);
  expect_outward_unit_normals(mesh, 0.99);
  EXPECT_NEAR(volume(mesh), 4.0 / 3 * kPi * 8, 0.2);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    ASSERT_LT(length(mesh.positions[i] - 2 * mesh.normals[i]), 1e-12);
}

TEST(TorusMesh, IsClosed) {
  const Mesh mesh = torus_mesh({}, 2, 0.5, {}, 64);
  expect_closed(mesh);
  expect_outward_unit_normals(mesh, 0.98);
  EXPECT_NEAR(volume(mesh), 2 * kPi * kPi * 2 * 0.25, 0.1);
}

TEST(Mesh, TransformScalesTurnsAndMoves) {
  const Mesh mesh =
      transformed(sphere_mesh(1, 16), {.scale = 3, .rotate_deg = {90, 0, 0}, .translate = {1, 2, 3}});
  expect_outward_unit_normals(mesh, 0.9);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    ASSERT_LT(length(mesh.positions[i] - (Vec3{1, 2, 3} + 3 * mesh.normals[i])), 1e-12);
  // The pole turned from +z to -y.
  EXPECT_NEAR(mesh.positions[8].y, 2 - 3, 1e-12);
}

const SnakeShape kShape{.body_radius = 0.5, .turns = 2.5, .resolution = 64};

TEST(Snake, IsClosedAndFacesOutwards) {
  const Mesh mesh = snake_mesh(kShape);
  expect_closed(mesh);
  // The tip of the tail and the mouth bend within a triangle.
  expect_outward_unit_normals(mesh, 0.3);
  EXPECT_GT(volume(mesh), 0);
}

TEST(Snake, CoordinatesDoNotJumpAndScalesAreNotStretched) {
  const Mesh mesh = snake_mesh(kShape);
  double least_v = 1e300, most_v = -1e300;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2 &p = mesh.uvs[t[k]], &q = mesh.uvs[t[(k + 1) % 3]];
      ASSERT_LT(std::abs(p.x - q.x), 1.01 / 64);
      ASSERT_LT(std::abs(p.y - q.y), 1.5 / 32);
      least_v = std::min(least_v, p.y), most_v = std::max(most_v, p.y);
    }
  EXPECT_EQ(least_v, 0);
  EXPECT_GT(most_v, 5);
  // On the body (not tail, head or eyes) a unit of u is as long as one of v, up to the bend of the coil.
  const std::vector<UvDerivatives> derivatives = vertex_derivatives(mesh);
  double log_ratio = 0, worst = 0;
  int count = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.uvs[i].y < 0.5 * most_v || mesh.uvs[i].y > 0.8 * most_v) continue;
    if (length(derivatives[i].du) == 0) continue;
    const double ratio = std::log(length(derivatives[i].dv) / length(derivatives[i].du));
    log_ratio += ratio, worst = std::max(worst, std::abs(ratio)), ++count;
    ASSERT_LT(std::abs(dot(normalize(derivatives[i].du), normalize(derivatives[i].dv))), 0.1);
  }
  ASSERT_GT(count, 1000);
  EXPECT_NEAR(log_ratio / count, 0, 0.05);
  EXPECT_LT(worst, 0.6);
}

TEST(Snake, BellyIsDownAndBackIsUp) {
  const Mesh mesh = snake_mesh(kShape);
  double most_v = 0;
  for (const Point2& uv : mesh.uvs) most_v = std::max(most_v, uv.y);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Point2& uv = mesh.uvs[i];
    if (uv.y < 0.1 * most_v || uv.y > 0.75 * most_v) continue;  // the neck may be steep
    if (uv.x == 0 || uv.x == 1) {
      ASSERT_LT(mesh.normals[i].z, -0.8) << uv.y / most_v;
    }
    if (uv.x == 0.5) {
      ASSERT_GT(mesh.normals[i].z, 0.8) << uv.y / most_v;
    }
  }
}

TEST(Snake, RestsOnTheGround) {
  const Mesh mesh = snake_mesh(kShape);
  double lowest = 1e300;
  for (const Vec3& p : mesh.positions) lowest = std::min(lowest, p.z);
  EXPECT_NEAR(lowest, 0, 0.02 * kShape.body_radius);
}

// Parts of the body that are far apart along it keep their distance, up to a tenth of their widths: coils
// that rest on each other are pressed a little.
TEST(Snake, DoesNotPassThroughItself) {
  for (const double turns : {1.0, 1.75, 2.5, 3.4, 6.0}) {
    const std::vector<SnakePoint> line = snake_centerline({.turns = turns}, 600);
    double least = 1e300;
    for (const SnakePoint& a : line)
      for (const SnakePoint& b : line) {
        if (b.arc - a.arc < 4 * (a.half_width + b.half_width) + 1) continue;
        least = std::min(least, length(a.position - b.position) / (a.half_width + b.half_width));
      }
    EXPECT_GT(least, 0.9) << turns;
  }
}

TEST(Snake, HeadIsWiderThanTheNeckAndFlat) {
  const Mesh mesh = snake_mesh(kShape);
  const std::vector<SnakePoint> line = snake_centerline(kShape, 400);
  double head = 0, neck = 1e300;
  for (const SnakePoint& p : line) {
    const double back = line.back().arc - p.arc;
    if (back < 3) head = std::max(head, p.half_width);
    if (back > 2 && back < 6) neck = std::min(neck, p.half_width);
  }
  EXPECT_GT(head, 1.5 * neck);
  EXPECT_EQ(line.back().half_width, 0);
}

TEST(Snake, FollowsItsParameters) {
  const Mesh small = snake_mesh({.body_radius = 0.25, .turns = 2, .resolution = 32});
  const Mesh large = snake_mesh({.body_radius = 0.5, .turns = 2, .resolution = 32});
  const Mesh fine = snake_mesh({.body_radius = 0.25, .turns = 2, .resolution = 64});
  ASSERT_EQ(small.positions.size(), large.positions.size());
  for (std::size_t i = 0; i < small.positions.size(); ++i)
    ASSERT_LT(length(2 * small.positions[i] - large.positions[i]), 1e-12);
  EXPECT_GT(fine.triangles.size(), 3 * small.triangles.size());
  EXPECT_NEAR(volume(fine), volume(small), 0.02 * volume(fine));
}

}  // namespace
}  // namespace sunbeam
