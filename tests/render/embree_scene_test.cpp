// Hits on every kind of surface, seen from outside and inside, and offsets that keep rays from hitting their
// own surface again.
#include "runtime/tracer/embree_scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "runtime/tracer/obj.h"
#include "sunbeam/core/frame.h"
#include "sunbeam/detail/warp.h"
#include "tests/render/support.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Scene with(std::variant<Sphere, Mesh> shape) {
  Scene scene;
  scene.materials.push_back({});
  scene.objects.push_back({std::move(shape), 0});
  return scene;
}

void expect_near(const Vec3& found, const Vec3& expected, double tolerance) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(found.z, expected.z, tolerance);
}

TEST(EmbreeScene, SphereFromOutsideAndInside) {
  const Scene scene = with(Sphere{{10, 20, 30}, 2});
  const EmbreeScene geometry(scene);
  const auto outside = geometry.intersect({{10, 15, 30}, {0, 1, 0}});
  ASSERT_TRUE(outside);
  expect_near(outside->position, {10, 18, 30}, 1e-12);
  expect_near(outside->geometric_normal, {0, -1, 0}, 1e-6);
  EXPECT_NEAR(outside->distance, 3, 1e-6);
  EXPECT_EQ(outside->object, 0);
  EXPECT_EQ(outside->light, -1);
  const auto inside = geometry.intersect({{10, 20, 30}, {0, 0, -1}});
  ASSERT_TRUE(inside);
  expect_near(inside->position, {10, 20, 28}, 1e-12);
  expect_near(inside->geometric_normal, {0, 0, -1}, 1e-6);  // outwards on both sides
  EXPECT_FALSE(geometry.intersect({{10, 15, 30}, {0, -1, 0}}));
  EXPECT_FALSE(geometry.intersect({{12.01, 15, 30}, {0, 1, 0}}));
}

TEST(EmbreeScene, TorusNormalsAreTheAnalyticOnes) {
  const Scene scene = with(torus_mesh({0, 0, 1}, 2, 0.5, {}, 256));
  const EmbreeScene geometry(scene);
  const auto top = geometry.intersect({{0, -2, 5}, {0, 0, -1}});
  ASSERT_TRUE(top);
  expect_near(top->position, {0, -2, 1.5}, 1e-3);
  expect_near(top->shading_normal, {0, 0, 1}, 1e-3);
  const auto outer = geometry.intersect({{5, 0, 1}, {-1, 0, 0}});
  ASSERT_TRUE(outer);
  expect_near(outer->position, {2.5, 0, 1}, 1e-3);
  expect_near(outer->shading_normal, {1, 0, 0}, 1e-3);
  EXPECT_GT(dot(outer->geometric_normal, outer->shading_normal), 0.99);
  EXPECT_FALSE(geometry.intersect({{0, 0, 5}, {0, 0, -1}}));  // through the hole
}

TEST(EmbreeScene, TorusIsClosedAndFacesOutwards) {
  const Mesh mesh = torus_mesh({1, 2, 3}, 2, 0.5, {10, 20, 30}, 256);
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 winding = cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    ASSERT_GT(dot(winding, mesh.normals[a]), 0);
    area += length(winding) / 2;
  }
  EXPECT_NEAR(area, 4 * kPi * kPi * 2 * 0.5, 0.02);  // 4 pi^2 R r, less about 5 / resolution^2 of it
}

TEST(EmbreeScene, TorusTurnsAboutXThenYThenZ) {
  // About x by 90 degrees the axis turns from z to -y; about z by 90 degrees on to +x.
  const Scene scene = with(torus_mesh({}, 2, 0.5, {90, 0, 90}, 128));
  const EmbreeScene geometry(scene);
  EXPECT_FALSE(geometry.intersect({{5, 0, 0}, {-1, 0, 0}}));
  const auto side = geometry.intersect({{5, 2, 0}, {-1, 0, 0}});
  ASSERT_TRUE(side);
  expect_near(side->position, {0.5, 2, 0}, 1e-3);
  expect_near(side->shading_normal, {1, 0, 0}, 1e-3);
}

TEST(EmbreeScene, ObjQuadWithNormalsScaleAndTranslation) {
  const ScratchFolder folder;
  const std::string path = folder.write("quad.obj",
                                        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                                        "vn -1 0 1\nvn 1 0 1\nvn 1 0 1\nvn -1 0 1\n"
                                        "f 1//1 2//2 3//3 4//4\n");
  const Scene scene = with(transformed(load_obj(path).mesh, {.scale = 2, .translate = {0, 0, 3}}));
  const EmbreeScene geometry(scene);
  const auto middle = geometry.intersect({{0, 0.1, 9}, {0, 0, -1}});
  ASSERT_TRUE(middle);
  expect_near(middle->position, {0, 0.1, 3}, 1e-6);
  expect_near(middle->shading_normal, {0, 0, 1}, 1e-6);
  const auto right = geometry.intersect({{1, 0.1, 9}, {0, 0, -1}});  // half way to the edge at x = 2
  ASSERT_TRUE(right);
  expect_near(right->geometric_normal, {0, 0, 1}, 1e-6);
  expect_near(right->shading_normal, normalize(Vec3{0.5, 0, 1}), 1e-6);
  EXPECT_FALSE(geometry.intersect({{2.1, 0, 9}, {0, 0, -1}}));
}

TEST(EmbreeScene, ObjWithoutNormalsIsFlatAndNegativeIndicesWork) {
  const ScratchFolder folder;
  const Mesh mesh = load_obj(folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n")).mesh;
  EXPECT_TRUE(mesh.normals.empty());
  ASSERT_EQ(mesh.triangles.size(), 1u);
  const Scene scene = with(mesh);
  const auto hit = EmbreeScene(scene).intersect({{0.2, 0.2, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  expect_near(hit->shading_normal, {0, 0, 1}, 1e-12);
}

TEST(EmbreeScene, QuadLightsAreHitAsLights) {
  Scene scene = with(Sphere{{0, 0, 0}, 1});
  scene.quad_lights.push_back({{-1, -1, 5}, {0, 2, 0}, {2, 0, 0}, Rgb(1)});
  const EmbreeScene geometry(scene);
  const auto hit = geometry.intersect({{0, 0, 3}, {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->light, 0);
  EXPECT_EQ(hit->object, -1);
  expect_near(hit->geometric_normal, {0, 0, -1}, 1e-12);
}

TEST(EmbreeScene, OcclusionEndsAtTheDistance) {
  const Scene scene = with(Sphere{{0, 0, 0}, 1});
  const EmbreeScene geometry(scene);
  const Ray ray{{0, 0, 4}, {0, 0, -1}};
  EXPECT_FALSE(geometry.occluded(ray, 2.99));
  EXPECT_FALSE(geometry.occluded(ray, 3));  // the end point itself does not count
  EXPECT_TRUE(geometry.occluded(ray, 3.01));
  EXPECT_TRUE(geometry.occluded(ray, kInfinity));
  EXPECT_FALSE(geometry.occluded({{0, 0, 4}, {0, 0, 1}}, kInfinity));
}

// Rays that leave a convex surface upwards must find nothing, even far from the origin and at grazing angles.
void expect_no_self_hits(const Scene& scene, const Vec3& from, const Vec3& target, double spread) {
  const EmbreeScene geometry(scene);
  Rng rng(11, 0);
  int tried = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 aim = target + spread * sample_sphere({rng.uniform(), rng.uniform()});
    const auto hit = geometry.intersect({from, normalize(aim - from)});
    if (!hit) continue;
    ++tried;
    const double side = dot(hit->geometric_normal, from - hit->position) < 0 ? -1 : 1;
    const Vec3 normal = side * hit->geometric_normal;
    const double height = std::pow(10.0, -6 * rng.uniform());
    const Vec3 leaving =
        Frame::from_normal(normal).to_world(direction_from_cosine(height, 2 * kPi * rng.uniform()));
    ASSERT_FALSE(geometry.occluded({hit->position + hit->offset * normal, leaving}, kInfinity))
        << "ray " << i;
  }
  EXPECT_GT(tried, 1000);
}

TEST(EmbreeScene, RaysLeaveTheirOwnSurface) {
  expect_no_self_hits(with(Sphere{{0, 0, 0}, 1}), {0, -5, 2}, {0, 0, 0}, 1);
  expect_no_self_hits(with(Sphere{{1000, -300, 20}, 0.5}), {1000, -305, 22}, {1000, -300, 20}, 0.5);
  expect_no_self_hits(with(quad_mesh({-50, -50, 0}, {100, 0, 0}, {0, 100, 0})), {3, 2, 5}, {10, 10, 0}, 20);
  expect_no_self_hits(with(quad_mesh({900, 900, 1}, {10, 0, 10}, {0, 10, 0})), {905, 905, 20}, {905, 905, 6},
                      4);
}

}  // namespace
}  // namespace sunbeam
