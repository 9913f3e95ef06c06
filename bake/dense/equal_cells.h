// This file finds the cells of one parameter node of a dense table whose values are equal, because the
// surface is its own mirror image, because light may be reversed, or because a direction along z has no
// azimuth.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "bake/recipe/recipe.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {

// Holds one number a cell: for each wi, those of every wo of the table. It is the rest or its standard error,
// 1/sr.
using Rows = std::vector<std::vector<Rgb>>;

class EqualCells {
 public:
  // Finds the classes of equal cells. `azimuths` is the number over phi_o, as in Recipe; a film is isotropic
  // or has azimuths / 4 + 1 of them over phi_i.
  EqualCells(bool is_isotropic, std::size_t cosines, std::size_t azimuths);

  // Replaces the values of each class of equal cells by their mean. That lowers noise, and symmetries hold to
  // the last bit.
  void average(Rows& values) const;
  // Replaces standard errors by those of these means. Cells of a row share their walks, so their errors add
  // up; those of different rows do not.
  void average_errors(Rows& errors) const;

 private:
  using Cells = std::vector<std::pair<std::size_t, std::size_t>>;  // (row, place in it), by row

  struct End {
    std::size_t cosine, azimuth;  // nodes; azimuths of an anisotropic table in steps from the x axis
  };

  std::size_t number(const End& i, const End& o) const;
  std::size_t key(End i, End o) const;
  static void spread(const Rgb& mean, const Cells& cells, Rows& rows);

  bool is_isotropic_;
  std::size_t cosines_, azimuths_;
  std::vector<Cells> classes_;
};

}  // namespace sunbeam
