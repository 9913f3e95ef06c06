// This file makes L and X of a textured table (sunbeam/textured_table.h) from a factored one, whose arrays
// sunbeam/detail/factors.h describes. runtime/src/lookup/textured_rest.h looks them up.
#pragma once

#include <vector>

#include "runtime/src/rest/textured_grid.h"
#include "runtime/src/rest/textured_media.h"

namespace sunbeam {
inline namespace v1 {

struct TexturedFit {
  std::vector<Color4> nodes;  // L, as TexturedGrid::row() says
  std::vector<Color4> pairs;  // X, as TexturedGrid::first_pair() says; path "product" only
};

TexturedFit fit_textured(const Table& table, const TexturedGrid& grid, const TexturedMedia& media);

}  // namespace v1
}  // namespace sunbeam
