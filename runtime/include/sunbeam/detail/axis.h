// This file describes one axis of a table: its nodes, and how to find a value between them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "sunbeam/core/export.h"
#include "sunbeam/detail/bracket.h"

namespace sunbeam {
inline namespace v1 {

// Holds the nodes that a value between them is made of, and their weights, which add up to 1.
struct Stencil {
  std::size_t count = 1;
  std::array<std::size_t, 4> node{};
  std::array<double, 4> weight{1};
};

// Interpolation is by polynomials in a coordinate of y = x - origin:
//
//   u(x) = sign(y) |y|^(1 / power)         power 1 is y itself; 2 and 3 suit quantities that behave like a
//                                          square or cube root at the origin
//   u(x) = y / sqrt(|y| + softness)        where softness > 0; the power is then 2
//
// A root without softness has a kink at its origin. One that lies within the axis is a node, and no
// polynomial reaches across it. A periodic axis (period > 0) has its nodes in [first, first + period) and
// wraps round; it is linear.
struct SUNBEAM_EXPORT Axis {
  std::string name;
  std::string unit;
  std::vector<double> nodes;  // strictly increasing, at least one
  double power = 1;
  double period = 0;
  double origin = 0;
  bool is_cubic = false;  // through the four nearest nodes (Lagrange), as many as there are; else linear
  double softness = 0;

  std::size_t size() const { return nodes.size(); }
  double low() const { return nodes.front(); }
  double high() const { return period > 0 ? nodes.front() + period : nodes.back(); }
  double coordinate(double x) const;
  // Returns the x of a coordinate.
  double at_coordinate(double u) const;

  // Names some nodes that follow one another.
  struct Run {
    std::size_t first, count;
  };
  // Returns the nodes that a polynomial between the nodes `lower` and lower + 1 may go through.
  Run smooth_run(std::size_t lower) const;

  // These find x among the nodes. They clamp to the first or last node and wrap a periodic axis.
  Bracket locate(double x) const;
  Stencil stencil(double x) const;

  // Returns an empty text if the axis is sound, else what is wrong with it.
  std::string defect() const;

  bool operator==(const Axis&) const = default;
};

// Returns `count` nodes from `from` to `to`, uniform in the axis coordinate of the given power and origin.
std::vector<double> spaced_nodes(double from, double to, std::size_t count, double power = 1,
                                 double origin = 0);
// Returns `count` nodes that are uniform in the coordinate of `axis`, whose own nodes do not matter. Across a
// kink, which takes three nodes at least, either side is uniform by itself.
std::vector<double> spaced_nodes(const Axis& axis, double from, double to, std::size_t count);

// Returns how many of the intervals of an axis lie below a kink that is `below` from one end and `above` from
// the other, in its coordinate.
std::size_t intervals_below(std::size_t intervals, double below, double above);

}  // namespace v1
}  // namespace sunbeam
