// This file makes the arrays of a textured table whose film is layered (sunbeam/textured_table.h) from a
// factored one, whose arrays sunbeam/detail/factors.h describes.
#pragma once

#include <vector>

#include "runtime/src/base/color4.h"
#include "runtime/src/textured/layered_grid.h"

namespace sunbeam {
inline namespace v1 {

// Holds what layered_grid.h lays out. What is empty has no cells there.
struct LayeredArrays {
  LayeredArrays(const Table& table, const LayeredGrid& grid, const Color4& absorption);

  std::vector<Color4> film;    // R
  std::vector<Color4> shares;  // P
  std::vector<Color4> logs;    // L; the last lane is the chance of sampling the first surface
  std::vector<Color4> pairs;   // X

  std::size_t bytes() const {
    return (film.size() + shares.size() + logs.size() + pairs.size()) * sizeof(Color4);
  }
};

}  // namespace v1
}  // namespace sunbeam
