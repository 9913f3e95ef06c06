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

// Of the body, from the tip of the tail to the nape.
double length_in_v(const Mesh& mesh) {
  double least = 0;
  for (const Point2& uv : mesh.uvs) least = std::min(least, uv.y);
  return -least;
}

TEST(Snake, CoordinatesDoNotJumpAndScalesAreNotStretched) {
  const Mesh mesh = snake_mesh(kShape);
  const double most_v = length_in_v(mesh);
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2 &p = mesh.uvs[t[k]], &q = mesh.uvs[t[(k + 1) % 3]];
      ASSERT_LT(std::abs(p.x - q.x), 1.01 / 64);
      ASSERT_LT(std::abs(p.y - q.y), 1.5 / 32);
    }
  EXPECT_GT(most_v, 5);
  // On the body (not tail, head or eyes) a unit of u is as long as one of v, up to the bend of the coil.
  const std::vector<UvDerivatives> derivatives = vertex_derivatives(mesh);
  double log_ratio = 0, worst = 0;
  int count = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const double from_tail = mesh.uvs[i].y + most_v;
    if (from_tail < 0.5 * most_v || from_tail > 0.8 * most_v) continue;
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
  const double most_v = length_in_v(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Point2& uv = mesh.uvs[i];
    const double from_tail = (uv.y + most_v) / most_v;
    if (from_tail < 0.1 || from_tail > 0.75) continue;  // the neck may be steep
    if (uv.x == 0 || uv.x == 1) {
      ASSERT_LT(mesh.normals[i].z, -0.8) << from_tail;
    }
    if (uv.x == 0.5) {
      ASSERT_GT(mesh.normals[i].z, 0.8) << from_tail;
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

TEST(Snake, HeadIsALittleWiderThanTheNeckAndFlat) {
  const std::vector<SnakePoint> line = snake_centerline(kShape, 400);
  double head = 0, neck = 1e300;
  for (const SnakePoint& p : line) {
    const double back = line.back().arc - p.arc;
    if (back < 3) head = std::max(head, p.half_width);
    if (back > 2 && back < 6) neck = std::min(neck, p.half_width);
  }
  EXPECT_GT(head, 1.3 * neck);
  EXPECT_LT(head, 1.6 * neck);
  EXPECT_EQ(line.back().half_width, 0);
}

// What relief maps of heads rely on, at every resolution: v is 0 at the nape, 3.5 body radii behind the
// snout, and stays below 1.
TEST(Snake, HeadFillsTheFirstUnitOfV) {
  for (const int resolution : {16, 64, 192}) {
    const Mesh skin = make_snake({.body_radius = 1, .resolution = resolution}).skin;
    double snout = 0;
    for (const Point2& uv : skin.uvs) snout = std::max(snout, uv.y);
    EXPECT_NEAR(snout, 0.95, 0.01) << resolution;
    const std::vector<SnakePoint> line = snake_centerline({.body_radius = 1}, 4000);
    for (std::size_t i = 0; i < skin.uvs.size(); ++i) {
      if (skin.uvs[i].x != 0.25) continue;  // the right side, level with the centreline
      const auto nearest = std::min_element(line.begin(), line.end(), [&](auto& a, auto& b) {
        return length(a.position - skin.positions[i]) < length(b.position - skin.positions[i]);
      });
      const double back = line.back().arc - nearest->arc;
      if (std::abs(back - 3.5) < 0.1 || back > 5) continue;
      ASSERT_EQ(skin.uvs[i].y<0, back> 3.5) << resolution << ' ' << back;
    }
  }
}

// Two closed spheres, mirror images, each for the most part within the head, its cap outside.
TEST(Snake, EyesAreSetInTheHead) {
  const Snake snake = make_snake({.body_radius = 1, .resolution = 128});
  expect_closed(snake.eyes);
  const std::size_t half = snake.eyes.positions.size() / 2;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Point2& uv = snake.eyes.uvs[eye * half];
    std::vector<std::size_t> around;  // vertices of the skin
    for (std::size_t k = 0; k < snake.skin.uvs.size(); ++k)
      if (std::hypot(snake.skin.uvs[k].x - uv.x, snake.skin.uvs[k].y - uv.y) < 0.1) around.push_back(k);
    std::size_t outside = 0;
    double farthest = 0;
    for (std::size_t i = eye * half; i < (eye + 1) * half; ++i) {
      const Vec3& p = snake.eyes.positions[i];
      const auto nearest = *std::min_element(around.begin(), around.end(), [&](std::size_t a, std::size_t b) {
        return length(p - snake.skin.positions[a]) < length(p - snake.skin.positions[b]);
      });
      const double height = dot(p - snake.skin.positions[nearest], snake.skin.normals[nearest]);
      outside += height > 0;
      farthest = std::max(farthest, height);
    }
    const double share = static_cast<double>(outside) / static_cast<double>(half);
    EXPECT_GT(share, 0.03);
    EXPECT_LT(share, 0.25);
    EXPECT_GT(farthest, 0.01);
    EXPECT_LT(farthest, 0.05);
    EXPECT_NEAR(snake.eyes.uvs[0].x + snake.eyes.uvs[half].x, 1, 1e-12);
  }
  EXPECT_EQ(snake_mesh({.body_radius = 1, .resolution = 128}).triangles.size(),
            snake.skin.triangles.size() + snake.eyes.triangles.size());
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
