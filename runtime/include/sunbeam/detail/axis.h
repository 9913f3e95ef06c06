// This file describes one axis of a table: its nodes, and how to find a value between them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "sunbeam/detail/bracket.h"

namespace sunbeam {
inline namespace v1 {

// Holds the nodes that a value between them is made of, and their weights, which add up to 1.
struct Stencil {
  std::size_t count = 1;
  std::array<std::size_t, 4> node{};
  std::array<double, 4> weight{1};
};

// Interpolation is by polynomials in the coordinate u(x) = (x - origin)^(1 / power); power 1 is x itself, 2
// and 3 suit quantities that behave like a square or cube root at the origin, which no node may lie below. A
// periodic axis (period > 0) has its nodes in [first, first + period) and wraps round; it is linear.
struct Axis {
  std::string name;
  std::string unit;
  std::vector<double> nodes;  // strictly increasing, at least one
  double power = 1;
  double period = 0;
  double origin = 0;
  bool is_cubic = false;  // through the four nearest nodes (Lagrange), as many as there are; else linear

  std::size_t size() const { return nodes.size(); }
  double low() const { return nodes.front(); }
  double high() const { return period > 0 ? nodes.front() + period : nodes.back(); }
  double coordinate(double x) const;

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

}  // namespace v1
}  // namespace sunbeam
