#include "runtime/tracer/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/tracer/point_tree.h"

namespace sunbeam {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Newell's: its length is twice the area of a plane polygon, however concave.
Vec3 newell_normal(const std::vector<Vec3>& corners) {
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum = sum + cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return sum;
}

// Leaves out the coordinate along which the normal is longest, so that no coordinate is rounded. The polygon
// becomes counter-clockwise.
void project(const std::vector<Vec3>& corners, const Vec3& normal, std::vector<Point2>& points) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  const bool drops_x = x >= y && x >= z, drops_y = !drops_x && y >= z;
  const bool is_turned = (drops_x ? normal.x : drops_y ? normal.y : normal.z) < 0;
  points.clear();
  for (const Vec3& p : corners) {
    const Point2 flat = drops_x ? Point2{p.y, p.z} : drops_y ? Point2{p.z, p.x} : Point2{p.x, p.y};
    points.push_back(is_turned ? Point2{flat.y, flat.x} : flat);
  }
}

bool is_convex(const std::vector<Point2>& points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    if (!(turn(points[i], points[(i + 1) % n], points[(i + 2) % n]) > 0)) return false;
  for (std::size_t i = 1; i + 1 < n; ++i)  // or it winds more than once
    if (!(turn(points[0], points[i], points[i + 1]) > 0)) return false;
  return true;
}

}  // namespace

// Clips ears, corners whose triangle lies inside the polygon, until three corners are left. A corner that is
// no ear waits for the corner that lies in its triangle, which makes the work n log n but for odd shapes.
class PolygonCutter::EarClipping {
 public:
  std::vector<Point2> points;  // of the polygon, counter-clockwise

  void cut(std::vector<Triangle>& triangles) {
    start();
    std::uint32_t left = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t corner; left > 3 && next_ear(corner); --left) {
      triangles.push_back({before_[corner], corner, after_[corner]});
      clip(corner);
    }
    // What is left is a triangle, or crosses itself.
    for (std::uint32_t second = after_[last_]; after_[second] != last_; second = after_[second])
      triangles.push_back({last_, second, after_[second]});
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  enum class State : unsigned char { convex, reflex, clipped };

  void start() {
    const std::uint32_t n = static_cast<std::uint32_t>(points.size());
    before_.resize(n), after_.resize(n), state_.resize(n);
    first_waiting_.assign(n, kNone);
    waiting_.clear();
    for (std::uint32_t i = 0; i < n; ++i) before_[i] = (i + n - 1) % n, after_[i] = (i + 1) % n;
    std::vector<std::uint32_t> reflex;
    for (std::uint32_t i = 0; i < n; ++i) {
      state_[i] = turn_at(i) > 0 ? State::convex : State::reflex;
      if (state_[i] == State::reflex) reflex.push_back(i);
    }
    tree_.build(points, std::move(reflex));
    spikes_.clear(), candidates_.clear(), flat_.clear(), blocked_.clear();
    is_candidate_.assign(n, false);
    for (std::uint32_t i = n; i-- > 0;) add_candidate(i);
    last_ = 0;
  }

  double turn_at(std::uint32_t corner) const {
    return turn(points[before_[corner]], points[corner], points[after_[corner]]);
  }

  // Finds the corner to clip: a spike, else an ear, else a corner on a line, else a convex corner.
  bool next_ear(std::uint32_t& corner) {
    while (take(spikes_, corner))
      if (state_[corner] != State::clipped && is_spike(corner)) return true;
    while (take(candidates_, corner)) {
      is_candidate_[corner] = false;
      if (state_[corner] == State::clipped) continue;
      const double area = turn_at(corner);
      if (area == 0) flat_.push_back(corner);
      if (!(area > 0)) continue;
      const std::uint32_t blocker = find_blocker(corner);
      if (blocker == kNone) return true;
      blocked_.push_back(corner);
      waiting_.push_back({corner, first_waiting_[blocker]});
      first_waiting_[blocker] = static_cast<std::uint32_t>(waiting_.size() - 1);
    }
    while (take(flat_, corner))
      if (state_[corner] != State::clipped && turn_at(corner) == 0) return true;
    while (take(blocked_, corner))
      if (state_[corner] != State::clipped && turn_at(corner) > 0) return true;
    return false;
  }

  // Says whether the edges of a corner run back on each other, or one has no length. Such a corner may seem
  // to be an ear of its neighbours.
  bool is_spike(std::uint32_t corner) const {
    const Point2 &a = points[before_[corner]], &b = points[corner], &c = points[after_[corner]];
    return turn(a, b, c) == 0 && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) <= 0;
  }

  void add_candidate(std::uint32_t corner) {
    if (is_spike(corner)) spikes_.push_back(corner);
    if (!is_candidate_[corner]) candidates_.push_back(corner);
    is_candidate_[corner] = true;
  }

  static bool take(std::vector<std::uint32_t>& stack, std::uint32_t& corner) {
    if (stack.empty()) return false;
    corner = stack.back();
    stack.pop_back();
    return true;
  }

  void clip(std::uint32_t corner) {
    const std::uint32_t previous = before_[corner], next = after_[corner];
    after_[previous] = next;
    before_[next] = previous;
    last_ = next;
    settle(corner, State::clipped);
    for (const std::uint32_t i : {previous, next}) {
      if (turn_at(i) > 0) settle(i, State::convex);
      add_candidate(i);
    }
  }

  // A corner that is not reflex any more blocks none; those that waited for it are candidates again.
  void settle(std::uint32_t corner, State state) {
    if (state_[corner] == State::reflex) {
      tree_.remove(corner);
      for (std::uint32_t i = first_waiting_[corner]; i != kNone; i = waiting_[i].next)
        add_candidate(waiting_[i].corner);
    }
    state_[corner] = state;
  }

  // Returns a reflex corner that lies in the triangle of a convex one.
  std::uint32_t find_blocker(std::uint32_t corner) const {
    const Triangle ear = {before_[corner], corner, after_[corner]};
    std::uint32_t blocker = kNone;
    tree_.any_near(points[ear[0]], points[ear[1]], points[ear[2]], [&](std::uint32_t i) {
      if (state_[i] != State::reflex || i == ear[0] || i == ear[2] || !blocks(ear, i)) return false;
      blocker = i;
      return true;
    });
    return blocker;
  }

  // Says whether a corner lies inside a triangle or within its new side, or touches it from where an edge
  // runs inside.
  bool blocks(const Triangle& ear, std::uint32_t corner) const {
    std::array<double, 3> side;
    for (std::size_t k = 0; k < 3; ++k)
      side[k] = turn(points[ear[k]], points[ear[(k + 1) % 3]], points[corner]);
    if (side[0] < 0 || side[1] < 0 || side[2] < 0) return false;
    if (side[2] == 0 && side[0] > 0 && side[1] > 0) return true;
    const auto runs_inside = [&](std::uint32_t to) {
      for (std::size_t k = 0; k < 3; ++k)
        if (side[k] == 0 && !(turn(points[ear[k]], points[ear[(k + 1) % 3]], points[to]) > 0)) return false;
      return true;
    };
    return runs_inside(before_[corner]) || runs_inside(after_[corner]);
  }

  struct Waiting {
    std::uint32_t corner, next;  // behind the same blocker
  };

  std::vector<std::uint32_t> before_, after_;  // neighbours of a corner
  std::vector<std::uint32_t> first_waiting_;   // behind a blocker
  std::vector<Waiting> waiting_;
  std::vector<State> state_;
  std::vector<std::uint32_t> spikes_, candidates_, flat_, blocked_;
  std::vector<bool> is_candidate_;
  std::uint32_t last_ = 0;  // a corner that is not clipped
  PointTree tree_;
};

PolygonCutter::PolygonCutter() : ear_clipping_(std::make_unique<EarClipping>()) {}
PolygonCutter::~PolygonCutter() = default;

void PolygonCutter::cut_fan(std::size_t corners) {
  for (std::uint32_t i = 1; i + 1 < corners; ++i) triangles_.push_back({0, i, i + 1});
}

const std::vector<Triangle>& PolygonCutter::cut(const std::vector<Vec3>& corners) {
  triangles_.clear();
  if (corners.size() <= 3) {
    cut_fan(corners.size());
    return triangles_;
  }
  const Vec3 normal = newell_normal(corners);
  std::vector<Point2>& points = ear_clipping_->points;
  project(corners, normal, points);
  const bool is_finite = std::isfinite(normal.x + normal.y + normal.z);
  if (!is_finite || is_convex(points))
    cut_fan(corners.size());
  else
    ear_clipping_->cut(triangles_);
  return triangles_;
}

}  // namespace sunbeam
