#include "runtime/tracer/scales.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/tracer/snake_scales.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

constexpr double kRowSpacing = std::numbers::sqrt3 / 2;

Point2 operator+(const Point2& a, const Point2& b) { return {a.x + b.x, a.y + b.y}; }
Point2 operator-(const Point2& a, const Point2& b) { return {a.x - b.x, a.y - b.y}; }
double length2(const Point2& a) { return square(a.x) + square(a.y); }

double wrap(double x, double period) {
  const double inside = x - period * std::floor(x / period);
  return inside < period ? inside : 0;  // rounding may reach the period
}

// Finds the points of a tile, repeated over the plane, that lie near a place: by bins about one unit wide.
class PeriodicBins {
 public:
  PeriodicBins(const std::vector<Point2>& points, const Point2& size)
      : points_(points),
        size_(size),
        columns_(std::max(1, static_cast<int>(size.x))),
        rows_(std::max(1, static_cast<int>(size.y))),
        bins_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    for (std::size_t i = 0; i < points.size(); ++i) bins_[bin_of(points[i])].push_back(i);
  }

  // Calls use(index, position) for every copy of a point within `radius` of `place`, and some further ones.
  template <class Use>
  void for_near(const Point2& place, double radius, Use use) const {
    const int left = column(place.x - radius), right = column(place.x + radius);
    const int bottom = row(place.y - radius), top = row(place.y + radius);
    for (int j = bottom; j <= top; ++j)
      for (int i = left; i <= right; ++i) {
        const int tile_x = floor_div(i, columns_), tile_y = floor_div(j, rows_);
        const Point2 shift = {tile_x * size_.x, tile_y * size_.y};
        for (const std::size_t point : bins_[bin(i - tile_x * columns_, j - tile_y * rows_)])
          use(point, points_[point] + shift);
      }
  }

  // Tells the bins that a point left `from`; the list of points already holds its new place.
  void moved(std::size_t point, const Point2& from) {
    std::erase(bins_[bin_of(from)], point);
    bins_[bin_of(points_[point])].push_back(point);
  }

 private:
  static int floor_div(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }
  int column(double x) const { return static_cast<int>(std::floor(x / size_.x * columns_)); }
  int row(double y) const { return static_cast<int>(std::floor(y / size_.y * rows_)); }
  std::size_t bin(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
  }
  std::size_t bin_of(const Point2& p) const {
    return bin(std::min(column(p.x), columns_ - 1), std::min(row(p.y), rows_ - 1));
  }

  const std::vector<Point2>& points_;
  Point2 size_;
  int columns_, rows_;
  std::vector<std::vector<std::size_t>> bins_;
};

std::vector<Point2> hexagonal_grid(const ScaleLayout& layout) {
  std::vector<Point2> centers;
  for (int j = 0; j < layout.rows; ++j)
    for (int i = 0; i < layout.columns; ++i)
      centers.push_back({i + (j % 2 == 0 ? 0.25 : 0.75), (j + 0.5) * kRowSpacing});
  return centers;
}

class HardDisks {
 public:
  HardDisks(std::vector<Point2>& centers, const Point2& size, double distance)
      : centers_(centers), size_(size), distance_(distance), bins_(centers, size) {}

  void sweep(double step, Rng& rng) {
    for (std::size_t i = 0; i < centers_.size(); ++i) {
      const Point2 move = {step * (2 * rng.uniform() - 1), step * (2 * rng.uniform() - 1)};
      const Point2 from = centers_[i], to = from + move;
      const Point2 wrapped = {wrap(to.x, size_.x), wrap(to.y, size_.y)};
      if (!is_free(i, wrapped)) continue;
      centers_[i] = wrapped;
      bins_.moved(i, from);
    }
  }

 private:
  // A tile so narrow that a centre meets its own copies has them at the width of the tile, which never
  // changes.
  bool is_free(std::size_t mover, const Point2& place) const {
    bool free = true;
    bins_.for_near(place, distance_, [&](std::size_t other, const Point2& at) {
      if (other != mover && length2(at - place) < square(distance_)) free = false;
    });
    return free;
  }

  std::vector<Point2>& centers_;
  Point2 size_;
  double distance_;
  PeriodicBins bins_;
};

double dome(double t) { return t >= 1 ? 1 : 1 - square(1 - std::max(t, 0.0)); }

std::vector<ScaleSite> sites_of(const ScaleLayout& layout) {
  switch (layout.pattern) {
    case ScalePattern::snake_body:
      return snake_body_sites(layout.columns, layout.rows);
    case ScalePattern::snake_head:
      return snake_head_sites(layout.columns, layout.rows);
    default: {
      std::vector<ScaleSite> sites;
      for (const Point2& center : scale_centers(layout)) sites.push_back({center});
      return sites;
    }
  }
}

std::vector<Point2> centers_of(const std::vector<ScaleSite>& sites) {
  std::vector<Point2> centers;
  for (const ScaleSite& site : sites) centers.push_back(site.center);
  return centers;
}

// Heights over the cells of sites that repeat with a tile.
class Cells {
 public:
  // No border between a place and a site beyond `reach` is nearer than half a scale width.
  Cells(std::vector<ScaleSite> sites, const Point2& size, double reach)
      : sites_(std::move(sites)), centers_(centers_of(sites_)), bins_(centers_, size), reach_(reach) {}
  Cells(const Cells&) = delete;
  Cells& operator=(const Cells&) = delete;

  double height(const Point2& place, double edge) {
    find_near(place);
    const Near own = *std::min_element(near_.begin(), near_.end(),
                                       [](auto& a, auto& b) { return a.distance < b.distance; });
    borders_.clear();
    for (const Near& other : near_) {
      if (length2(other.scale - own.scale) < 1e-12) continue;
      const double behind = other.distance - own.distance;
      const double twice = 2 * std::sqrt(length2(other.point - own.point));
      if (behind < edge * twice) add_border(other.scale, behind / twice / edge);
    }
    double height = 1;
    for (const Border& border : borders_) height *= dome(border.distance);
    return height;
  }

 private:
  // Of a site: its point nearest to the place, which scale it belongs to, the distance squared less the
  // weight.
  struct Near {
    Point2 point, scale;
    double distance;
  };
  struct Border {
    Point2 scale;  // that lies beyond
    double distance;
  };

  void find_near(const Point2& place) {
    near_.clear();
    bins_.for_near(place, reach_, [&](std::size_t i, const Point2& at) {
      const ScaleSite& site = sites_[i];
      const Point2 point = {at.x + std::clamp(place.x - at.x, -site.half_length, site.half_length), at.y};
      near_.push_back({point, at - site.in_scale, length2(point - place) - site.weight});
    });
  }

  // A scale of many sites has one border: the nearest.
  void add_border(const Point2& scale, double distance) {
    for (Border& border : borders_)
      if (length2(border.scale - scale) < 1e-12) {
        border.distance = std::min(border.distance, distance);
        return;
      }
    borders_.push_back({scale, distance});
  }

  std::vector<ScaleSite> sites_;
  std::vector<Point2> centers_;
  PeriodicBins bins_;
  double reach_;
  std::vector<Near> near_;  // these two: of the place at hand, kept for their memory
  std::vector<Border> borders_;
};

}  // namespace

Point2 tile_size(const ScaleLayout& layout) {
  return {static_cast<double>(layout.columns), layout.rows * kRowSpacing};
}

double min_center_distance(const ScaleLayout& layout) { return 1 - 0.3 * layout.jitter; }

std::vector<Point2> scale_centers(const ScaleLayout& layout) {
  constexpr int kSweeps = 200;  // the grid's order is forgotten long before
  std::vector<Point2> centers = hexagonal_grid(layout);
  if (layout.jitter == 0) return centers;
  HardDisks disks(centers, tile_size(layout), min_center_distance(layout));
  Rng rng(layout.seed, 0);
  for (int i = 0; i < kSweeps; ++i) disks.sweep(0.3 * layout.jitter, rng);
  return centers;
}

HeightMap scale_height_map(const ScaleLayout& layout, double edge, int pixels_per_scale) {
  const Point2 size = tile_size(layout);
  constexpr double kReach = 2.25, kReachOfShields = 0.105;  // the latter of the girth
  const bool is_head = layout.pattern == ScalePattern::snake_head;
  Cells cells(sites_of(layout), size, is_head ? std::max(kReach, kReachOfShields * layout.columns) : kReach);
  HeightMap map{static_cast<int>(std::lround(size.x * pixels_per_scale)),
                static_cast<int>(std::lround(size.y * pixels_per_scale)),
                {}};
  const bool is_snake = layout.pattern != ScalePattern::grid;  // its sides are alike
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      const int mirrored = map.width - 1 - column;
      if (is_snake && mirrored < column) {
        map.values.push_back(map.at(mirrored, row));
        continue;
      }
      const Point2 place = {size.x * (column + 0.5) / map.width, size.y * (1 - (row + 0.5) / map.height)};
      map.values.push_back(static_cast<float>(cells.height(place, edge)));
    }
  return map;
}

}  // namespace sunbeam
