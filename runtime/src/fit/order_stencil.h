// Values over fringe orders at any order, for many of them at once.
#pragma once

#include <array>
#include <vector>

#include "sunbeam/detail/axis.h"

namespace sunbeam::inline v1 {

// Where a fringe order lies among the nodes of an array, whose axis is even or has one node. Four nodes
// always, so that loops have no branch; arrays carry kMoreOrders rows more.
struct OrderStencil {
  std::size_t first = 0;
  std::array<float, 4> weight{1, 0, 0, 0};
};
inline constexpr std::size_t kMoreOrders = 3;

inline OrderStencil order_stencil(const Axis& axis, double order) {
  const Stencil at = axis.stencil(order);
  OrderStencil result;
  result.first = at.node[0];
  for (std::size_t k = 0; k < 4; ++k) result.weight[k] = k < at.count ? static_cast<float>(at.weight[k]) : 0;
  return result;
}

// `values` as (fringe_order, column), `stride` columns.
inline float blend(const std::vector<float>& values, const OrderStencil& at, std::size_t stride,
                   std::size_t column) {
  const float* from = values.data() + at.first * stride + column;
  return at.weight[0] * from[0] + at.weight[1] * from[stride] + at.weight[2] * from[2 * stride] +
         at.weight[3] * from[3 * stride];
}

}  // namespace sunbeam::inline v1
