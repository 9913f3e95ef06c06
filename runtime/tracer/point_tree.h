// This file finds points of a plane that lie near a triangle.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "sunbeam/detail/warp.h"

namespace sunbeam {

// Returns twice the signed area of a triangle, above 0 where it is wound counter-clockwise.
inline double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

struct Box {
  double low_x = std::numeric_limits<double>::infinity(), low_y = low_x;
  double high_x = -low_x, high_y = -low_x;

  void add(const Point2& p) {
    low_x = std::min(low_x, p.x), high_x = std::max(high_x, p.x);
    low_y = std::min(low_y, p.y), high_y = std::max(high_y, p.y);
  }
  bool meets(const Box& other) const {
    return low_x <= other.high_x && other.low_x <= high_x && low_y <= other.high_y && other.low_y <= high_y;
  }
  // Says whether all of it lies to the right of the line from a to b.
  bool is_right_of(const Point2& a, const Point2& b) const {
    const Point2 leftmost = {b.y > a.y ? low_x : high_x, b.x > a.x ? high_y : low_y};
    return turn(a, b, leftmost) < 0;
  }
};

// This is a binary tree of boxes, from which points can be removed.
class PointTree {
 public:
  // Takes those of `points` that `members` names; `points` must stay where they are.
  void build(const std::vector<Point2>& points, std::vector<std::uint32_t> members) {
    points_ = &points;
    order_ = std::move(members);
    place_.resize(points.size());
    nodes_.assign(order_.size() / 2 + 1, {});  // leaves hold more than kLeaf / 2
    if (!order_.empty()) build_node(0, 0, order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) place_[order_[i]] = i;
  }

  // Takes out a member that is still there.
  void remove(std::uint32_t point) {
    std::size_t node = 0, begin = 0, end = order_.size();
    for (--nodes_[0].count; end - begin > kLeaf; --nodes_[node].count) {
      const std::size_t middle = (begin + end) / 2;
      const bool is_left = place_[point] < middle;
      node = 2 * node + (is_left ? 1 : 2);
      (is_left ? end : begin) = middle;
    }
  }

  // Returns whether `use` returned true for a point; it is called for those in boxes that meet the triangle.
  template <class Use>
  bool any_near(const Point2& a, const Point2& b, const Point2& c, Use use) const {
    if (order_.empty()) return false;
    Box box;
    for (const Point2& p : {a, b, c}) box.add(p);
    const auto is_near = [&](const Box& other) {
      return box.meets(other) && !other.is_right_of(a, b) && !other.is_right_of(b, c) &&
             !other.is_right_of(c, a);
    };
    return search(0, 0, order_.size(), is_near, use);
  }

 private:
  static constexpr std::size_t kLeaf = 8;
  struct Node {
    Box box;
    std::size_t count = 0;  // of points that are not removed
  };

  void build_node(std::size_t node, std::size_t begin, std::size_t end) {
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.add((*points_)[order_[i]]);
    nodes_[node] = {box, end - begin};
    if (end - begin <= kLeaf) return;
    const bool splits_x = box.high_x - box.low_x > box.high_y - box.low_y;
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t i, std::uint32_t j) {
      const Point2 &p = (*points_)[i], &q = (*points_)[j];
      return splits_x ? p.x < q.x : p.y < q.y;
    });
    build_node(2 * node + 1, begin, middle);
    build_node(2 * node + 2, middle, end);
  }

  template <class IsNear, class Use>
  bool search(std::size_t node, std::size_t begin, std::size_t end, const IsNear& is_near, Use& use) const {
    if (nodes_[node].count == 0 || !is_near(nodes_[node].box)) return false;
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i)
        if (use(order_[i])) return true;
      return false;
    }
    const std::size_t middle = (begin + end) / 2;
    return search(2 * node + 1, begin, middle, is_near, use) ||
           search(2 * node + 2, middle, end, is_near, use);
  }

  const std::vector<Point2>* points_ = nullptr;
  std::vector<std::uint32_t> order_;
  std::vector<std::size_t> place_;  // of a point in order_
  std::vector<Node> nodes_;
};

}  // namespace sunbeam
