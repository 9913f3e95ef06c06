// Polygons: every shape is covered once, whatever its plane and however many corners it has.
#include "runtime/tracer/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <numbers>

#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

using Polygon = std::vector<Vec3>;

Vec3 area_of(const Polygon& corners, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return 0.5 * cross(corners[b] - corners[a], corners[c] - corners[a]);
}

Vec3 area_of(const Polygon& corners) {
  Vec3 sum;
  for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) sum = sum + area_of(corners, 0, i, i + 1);
  return sum;
}

// Triangles that cover a plane polygon once add up to its area without regard to their winding.
void expect_covered(const Polygon& corners, const std::string& what) {
  PolygonCutter cutter;
  const auto& triangles = cutter.cut(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2) << what;
  double sum = 0;
  Vec3 signed_sum;
  for (const auto& [a, b, c] : triangles) {
    sum += length(area_of(corners, a, b, c));
    signed_sum = signed_sum + area_of(corners, a, b, c);
  }
  const double area = length(area_of(corners));
  EXPECT_NEAR(sum, area, 1e-9 * area) << what;
  EXPECT_NEAR(length(signed_sum - area_of(corners)), 0, 1e-9 * area) << what;
}

// The polygon from every first corner, both ways round and in planes that face every axis.
void expect_covered_in_every_pose(const Polygon& corners, const std::string& what) {
  for (int pose = 0; pose < 4; ++pose) {
    Polygon posed;
    for (const Vec3& p : corners)
      posed.push_back(pose == 0   ? p
                      : pose == 1 ? Vec3{p.y, p.z, p.x}
                      : pose == 2 ? Vec3{p.z, p.x, p.y}
                                  : Vec3{p.x + p.y, p.y - 2 * p.x, 3 * p.x + p.y});
    for (std::size_t i = 0; i < posed.size(); ++i) {
      std::rotate(posed.begin(), posed.begin() + 1, posed.end());
      expect_covered(posed, what);
      std::reverse(posed.begin(), posed.end());
      expect_covered(posed, what + " reversed");
      std::reverse(posed.begin(), posed.end());
    }
  }
}

TEST(Polygon, ConcaveOnesAreCoveredOnce) {
  expect_covered_in_every_pose({{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5, 1, 0}}, "dart");
  expect_covered_in_every_pose({{1, 1, 0},
                                {1, -0.5, 0},
                                {-1, -0.5, 0},
                                {-1, 1, 0},
                                {-1.5, 1, 0},
                                {-1.5, -1, 0},
                                {1.5, -1, 0},
                                {1.5, 1, 0}},
                               "U");
  expect_covered_in_every_pose(
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 4, 0}, {3, 1, 0}, {2, 4, 0}, {1, 1, 0}, {0, 4, 0}}, "crown");
}

TEST(Polygon, CornersOnALineAndRepeatedOnesAreCovered) {
  expect_covered_in_every_pose(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}}, "square");
  expect_covered_in_every_pose({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 2, 0}}, "repeated last");
  expect_covered_in_every_pose(
      {{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 2, 0}, {1, 0.5, 0}, {0, 2, 0}},
      "repeated and concave");
  expect_covered_in_every_pose({{0, 0, 0}, {3, 0, 0}, {5, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}}, "spike");
}

// Exporters cut polygons with holes open by an edge that is walked twice.
TEST(Polygon, HolesBehindDoubleEdgesStayOpen) {
  expect_covered_in_every_pose({{0, 0, 0},
                                {4, 0, 0},
                                {4, 4, 0},
                                {0, 4, 0},
                                {0, 0, 0},
                                {1, 1, 0},
                                {1, 3, 0},
                                {3, 3, 0},
                                {3, 1, 0},
                                {1, 1, 0}},
                               "one hole");
  expect_covered_in_every_pose({{0, 0, 0},
                                {2, 0, 0},
                                {2, 1, 0},
                                {1, 2, 0},
                                {2, 3, 0},
                                {3, 2, 0},
                                {2, 1, 0},
                                {2, 0, 0},
                                {8, 0, 0},
                                {8, 4, 0},
                                {6, 3, 0},
                                {7, 2, 0},
                                {6, 1, 0},
                                {5, 2, 0},
                                {6, 3, 0},
                                {8, 4, 0},
                                {0, 4, 0}},
                               "two holes");
}

// Convex polygons keep the fan that they have always been.
TEST(Polygon, ConvexOnesBecomeAFan) {
  PolygonCutter cutter;
  const Polygon pentagon = {{0, 0, 1}, {2, 0, 1}, {3, 1, 1}, {1, 3, 1}, {-1, 1, 1}};
  const std::vector<std::array<std::uint32_t, 3>> fan = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(cutter.cut(pentagon), fan);
  EXPECT_TRUE(cutter.cut({{0, 0, 0}, {1, 0, 0}}).empty());
  EXPECT_TRUE(cutter.cut({}).empty());
}

TEST(Polygon, WithoutAPlaneItIsCutSomehow) {
  PolygonCutter cutter;
  const double nan = std::nan(""), inf = INFINITY;
  for (const Polygon& odd : {Polygon{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},  // a bow tie
                             Polygon(5, Vec3{1, 2, 3}), Polygon{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
                             Polygon{{0, 0, 0}, {nan, 0, 0}, {1, 1, 0}, {0, inf, 0}, {-1, 0, 0}},
                             Polygon{{1e308, 0, 0}, {-1e308, 1e308, 0}, {0, -1e308, 0}, {1, 2, 1e308}}}) {
    const auto& triangles = cutter.cut(odd);
    ASSERT_EQ(triangles.size(), odd.size() - 2);
    for (const auto& triangle : triangles)
      for (const std::uint32_t corner : triangle) EXPECT_LT(corner, odd.size());
  }
}

// Turns stretches of a closed path through random points until it does not cross itself.
Polygon random_polygon(Rng& rng, std::size_t size) {
  Polygon p(size);
  for (Vec3& corner : p) corner = {rng.uniform(), rng.uniform(), 0};
  const auto turn = [](const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a).z; };
  const auto cross_each_other = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
  };
  for (bool is_done = false; !is_done;) {
    is_done = true;
    for (std::size_t i = 0; i < size && is_done; ++i)
      for (std::size_t j = i + 2; j < size && is_done; ++j)
        if (cross_each_other(p[i], p[i + 1], p[j], p[(j + 1) % size])) {
          std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                       p.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          is_done = false;
        }
  }
  return p;
}

TEST(Polygon, RandomOnesAreCoveredOnce) {
  Rng rng(5, 0);
  for (std::size_t i = 0; i < 300; ++i) {
    const std::size_t size = 4 + i % 30;
    expect_covered(random_polygon(rng, size), "random " + std::to_string(i));
  }
}

Vec3 on_circle(double radius, double turns) {
  const double angle = 2 * std::numbers::pi * turns;
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

// Each would take minutes if every ear were held against every corner.
TEST(Polygon, AHundredThousandCornersTakeNoTime) {
  constexpr int kCorners = 100000;
  Polygon star, comb, spiral, waves;
  for (int i = 0; i < kCorners; ++i) {
    const double t = i / double{kCorners}, along = 2.0 * (i < kCorners / 2 ? t : 1 - t);
    star.push_back(on_circle(i % 2 ? 0.5 : 1, t));
    waves.push_back(on_circle(1 + 0.3 * std::sin(300 * t) + (i % 2) * 0.01, t));
    comb.push_back({double(i), i % 2 ? 0.0 : 100.0, 0});
    spiral.push_back(on_circle((i < kCorners / 2 ? 1 : 1.5) + 20 * along, 20 * along));
  }
  comb.push_back({kCorners, -1, 0});
  comb.push_back({-1, -1, 0});
  const std::clock_t start = std::clock();  // of this process, however busy the machine is
  for (const Polygon& polygon : {star, comb, spiral, waves}) expect_covered(polygon, "large");
  EXPECT_LT(std::clock() - start, 20 * CLOCKS_PER_SEC);
}

}  // namespace
}  // namespace sunbeam
