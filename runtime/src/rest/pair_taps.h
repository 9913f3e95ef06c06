// This file locates a direction among the even directions, as (phi, cosine), whose pairs textured tables
// hold.
#pragma once

#include <array>

#include "runtime/src/base/color4.h"

namespace sunbeam {
inline namespace v1 {

// Holds the neighbours of a direction, and their weights.
struct PairTaps {
  // `coordinate` is that of the cosine; `phi` is the azimuth folded into a quadrant, over pi/2.
  PairTaps(float coordinate, float phi, int cosines, int phis) {
    const EvenPosition c(coordinate, cosines);
    node = {c.lower, c.lower + 1};
    weight = {1 - c.upper_weight, c.upper_weight};
    if (phis == 1) return;
    const EvenPosition p(phi, phis);
    for (int k = 0; k < 2; ++k) {
      node[k] += p.lower * cosines;
      node[k + 2] = node[k] + cosines;
      weight[k + 2] = weight[k] * p.upper_weight;
      weight[k] *= 1 - p.upper_weight;
    }
    count = 4;
  }

  std::array<int, 4> node;
  std::array<float, 4> weight;
  int count = 2;
};

}  // namespace v1
}  // namespace sunbeam
