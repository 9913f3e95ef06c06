// Scales: the point sets, and the heights between them.
#include "runtime/tracer/scales.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "runtime/tracer/snake_scales.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

double distance(const Point2& a, const Point2& b) { return std::hypot(a.x - b.x, a.y - b.y); }

// All centres on the tile and on two rings of copies around it.
std::vector<Point2> with_copies(const ScaleLayout& layout) {
  const Point2 size = tile_size(layout);
  std::vector<Point2> all;
  for (const Point2& p : scale_centers(layout))
    for (int i = -2; i <= 2; ++i)
      for (int j = -2; j <= 2; ++j) all.push_back({p.x + i * size.x, p.y + j * size.y});
  return all;
}

double nearest_distance(const Point2& from, const std::vector<Point2>& points) {
  double least = 1e300;
  for (const Point2& p : points)
    if (const double d = distance(from, p); d > 1e-9) least = std::min(least, d);
  return least;
}

TEST(Scales, HexagonalCentersHaveSixNeighboursAtDistanceOne) {
  for (const ScaleLayout& layout : {ScaleLayout{}, ScaleLayout{.columns = 5, .rows = 6}}) {
    const std::vector<Point2> all = with_copies(layout);
    for (const Point2& center : scale_centers(layout)) {
      const auto neighbours = std::count_if(
          all.begin(), all.end(), [&](const Point2& p) { return std::abs(distance(p, center) - 1) < 1e-12; });
      EXPECT_EQ(neighbours, 6);
      EXPECT_NEAR(nearest_distance(center, all), 1, 1e-12);
    }
  }
}

TEST(Scales, BlueNoiseKeepsItsDistanceAcrossSeams) {
  for (const double jitter : {0.2, 0.6, 1.0})
    for (const std::uint64_t seed : {1, 2, 3}) {
      const ScaleLayout layout{.columns = 12, .rows = 14, .jitter = jitter, .seed = seed};
      const std::vector<Point2> centers = scale_centers(layout), all = with_copies(layout);
      const Point2 size = tile_size(layout);
      ASSERT_EQ(centers.size(), 12u * 14u);
      double least = 1e300;
      for (const Point2& center : centers) {
        ASSERT_TRUE(center.x >= 0 && center.x < size.x && center.y >= 0 && center.y < size.y);
        least = std::min(least, nearest_distance(center, all));
      }
      EXPECT_GE(least, min_center_distance(layout) - 1e-12);
      EXPECT_LT(least, min_center_distance(layout) + 0.03);  // else it is still the grid
    }
}

TEST(Scales, BlueNoiseHasNoOrderAtAFarDistance) {
  // Of 60-degree order |mean of exp(i k p)| at the reciprocal vectors of the grid is 1 on the grid and about
  // 1/sqrt(n) without order.
  const ScaleLayout layout{.columns = 24, .rows = 28, .jitter = 1};
  const std::vector<Point2> centers = scale_centers(layout);
  for (const Point2& k : {Point2{2 * kPi, 2 * kPi / std::sqrt(3.0)}, Point2{0, 4 * kPi / std::sqrt(3.0)}}) {
    double c = 0, s = 0;
    for (const Point2& p : centers)
      c += std::cos(k.x * p.x + k.y * p.y), s += std::sin(k.x * p.x + k.y * p.y);
    EXPECT_LT(std::hypot(c, s) / static_cast<double>(centers.size()), 0.25);
  }
}

TEST(Scales, SeedsDecide) {
  const ScaleLayout layout{.columns = 6, .rows = 6, .jitter = 1, .seed = 5};
  ScaleLayout other = layout;
  other.seed = 6;
  EXPECT_EQ(scale_height_map(layout, 0.4, 8).values, scale_height_map(layout, 0.4, 8).values);
  EXPECT_NE(scale_height_map(layout, 0.4, 8).values, scale_height_map(other, 0.4, 8).values);
}

// The definition, over all copies.
double reference_height(const std::vector<Point2>& all, const Point2& place, double edge) {
  const auto own = std::min_element(all.begin(), all.end(), [&](const Point2& a, const Point2& b) {
    return distance(a, place) < distance(b, place);
  });
  double height = 1;
  for (const Point2& p : all) {
    if (&p == &*own) continue;
    // The distance of `place` from the line half way between the two centres.
    const Point2 middle = {(p.x + own->x) / 2, (p.y + own->y) / 2};
    const double separation = distance(p, *own);
    const double d =
        ((middle.x - place.x) * (p.x - own->x) + (middle.y - place.y) * (p.y - own->y)) / separation;
    if (d < edge) height *= 1 - square(1 - d / edge);
  }
  return height;
}

void expect_reference_heights(const ScaleLayout& layout, double edge) {
  const HeightMap map = scale_height_map(layout, edge, 11);
  const std::vector<Point2> all = with_copies(layout);
  const Point2 size = tile_size(layout);
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      const Point2 place = {size.x * (column + 0.5) / map.width, size.y * (1 - (row + 0.5) / map.height)};
      ASSERT_NEAR(map.at(column, row), reference_height(all, place, edge), 1e-6) << column << ' ' << row;
    }
}

TEST(Scales, HeightsAreThoseOfAllCopiesOfAllCells) {
  expect_reference_heights({.columns = 3, .rows = 4}, 0.5);
  expect_reference_heights({.columns = 8, .rows = 8, .jitter = 1, .seed = 4}, 0.5);
  expect_reference_heights({.columns = 7, .rows = 6, .jitter = 0.5}, 0.3);
}

TEST(Scales, TheSmallestHexagonalTileIsTheLargeOneRepeated) {
  const HeightMap small = scale_height_map({}, 0.4, 16);
  const HeightMap large = scale_height_map({.columns = 3, .rows = 2}, 0.4, 16);
  ASSERT_EQ(large.height, small.height);
  for (int row = 0; row < large.height; ++row)
    for (int column = 0; column < large.width; ++column)
      ASSERT_NEAR(large.at(column, row), small.at(column % small.width, row), 1e-6);
}

TEST(Scales, HeightsSpanZeroToOne) {
  const HeightMap map = scale_height_map({.columns = 4, .rows = 4}, 0.3, 64);
  const auto [low, high] = std::minmax_element(map.values.begin(), map.values.end());
  EXPECT_GE(*low, 0);
  EXPECT_LT(*low, 0.05);
  EXPECT_EQ(*high, 1);  // the plateau
}

// --- snakes ---

// All sites on the tile and on a ring of copies around it.
std::vector<ScaleSite> with_copies(const std::vector<ScaleSite>& sites, const Point2& size) {
  std::vector<ScaleSite> all;
  for (const ScaleSite& site : sites)
    for (int i = -1; i <= 1; ++i)
      for (int j = -2; j <= 2; ++j) {
        all.push_back(site);
        all.back().center = {site.center.x + i * size.x, site.center.y + j * size.y};
      }
  return all;
}

// The definition, over all copies of segments with weights; sites of one scale share a border.
double reference_height(const std::vector<ScaleSite>& all, const Point2& place, double edge) {
  const auto foot = [&](const ScaleSite& site) {
    const double x = site.center.x;
    return Point2{std::clamp(place.x, x - site.half_length, x + site.half_length), site.center.y};
  };
  const auto power = [&](const ScaleSite& s) { return square(distance(foot(s), place)) - s.weight; };
  const auto scale = [](const ScaleSite& s) {  // rounded: a name
    return std::pair(std::lround(1e6 * (s.center.x - s.in_scale.x)),
                     std::lround(1e6 * (s.center.y - s.in_scale.y)));
  };
  const auto own = std::min_element(
      all.begin(), all.end(), [&](const ScaleSite& a, const ScaleSite& b) { return power(a) < power(b); });
  std::map<std::pair<long, long>, double> to_border;
  for (const ScaleSite& other : all) {
    if (scale(other) == scale(*own)) continue;
    const double d = (power(other) - power(*own)) / (2 * distance(foot(other), foot(*own)));
    const auto [at, is_new] = to_border.try_emplace(scale(other), d);
    if (!is_new) at->second = std::min(at->second, d);
  }
  double height = 1;
  for (const auto& [name, d] : to_border)
    if (d < edge) height *= 1 - square(1 - d / edge);
  return height;
}

const ScaleLayout kBody{.columns = 24, .rows = 2, .pattern = ScalePattern::snake_body};
const ScaleLayout kHead{.columns = 24, .rows = 28, .pattern = ScalePattern::snake_head};

TEST(SnakeScales, HeightsAreThoseOfAllCopiesOfAllScales) {
  for (const auto& [layout, sites] :
       {std::pair(kBody, snake_body_sites(24, 2)), std::pair(kHead, snake_head_sites(24, 28))}) {
    const HeightMap map = scale_height_map(layout, 0.4, 8);
    const Point2 size = tile_size(layout);
    const std::vector<ScaleSite> all = with_copies(sites, size);
    Rng rng(1, 0);
    for (int i = 0; i < 400; ++i) {
      const int column = static_cast<int>(rng.uniform() * map.width);
      const int row = static_cast<int>(rng.uniform() * map.height);
      const Point2 place = {size.x * (column + 0.5) / map.width, size.y * (1 - (row + 0.5) / map.height)};
      ASSERT_NEAR(map.at(column, row), reference_height(all, place, 0.4), 1e-5) << column << ' ' << row;
    }
  }
}

TEST(SnakeScales, HeightsSpanZeroToOne) {
  for (const ScaleLayout& layout : {kBody, kHead}) {
    const HeightMap map = scale_height_map(layout, 0.35, 16);
    const auto [low, high] = std::minmax_element(map.values.begin(), map.values.end());
    EXPECT_GE(*low, 0);
    EXPECT_LT(*low, 0.1);
    EXPECT_EQ(*high, 1);
  }
}

// One scute from side to side: a plateau across the whole belly, and a groove between it and the next.
TEST(SnakeScales, ScutesSpanTheBelly) {
  const HeightMap map = scale_height_map(kBody, 0.35, 32);
  for (const double u : {0.0, 0.02, 0.05, 0.08, 0.93, 0.97}) {
    EXPECT_GT(map.sample({u, 0.25}).height, 0.99) << u;  // of the first row, which has the scute
    EXPECT_LT(map.sample({u, 0.75}).height, 0.1) << u;
    EXPECT_NEAR(map.sample({u, 0.25}).gradient.x, 0, 1e-4) << u;
  }
  EXPECT_LT(map.sample({0.1, 0.25}).height, 0.1);  // where the hexagons begin
}

TEST(SnakeScales, HexagonsGrowTowardsTheBelly) {
  std::vector<double> row;
  for (const ScaleSite& site : snake_body_sites(36, 2))
    if (site.half_length == 0 && site.center.y < 0.5) row.push_back(site.center.x);
  const auto width = [&](std::size_t k) { return row[k + 1] - row[k]; };
  EXPECT_GT(width(0), 1.15 * width(row.size() / 2));
  EXPECT_NEAR(width(row.size() / 2), 1, 0.1);
  for (std::size_t k = 0; k + 1 < row.size() / 2; ++k) EXPECT_GE(width(k), width(k + 1) - 1e-12);
}

// Where v is 0 the head's map takes over from the body's: heights are the same.
TEST(SnakeScales, TheHeadContinuesTheBody) {
  const HeightMap body = scale_height_map(kBody, 0.35, 30), head = scale_height_map(kHead, 0.35, 30);
  const double tiles = 1.0 * kHead.rows / kBody.rows;
  double highest = 0;
  for (int i = 0; i < 400; ++i)
    for (const double v : {0.0, 0.004, 0.02}) {
      const double u = (i + 0.5) / 400, there = body.sample({u, v * tiles}).height;
      ASSERT_NEAR(head.sample({u, v}).height, there, 0.03) << u << ' ' << v;  // pixels differ a little
      highest = std::max(highest, there);
    }
  EXPECT_GT(highest, 0.99);
}

}  // namespace
}  // namespace sunbeam
