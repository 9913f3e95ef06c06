// This file makes X of a textured table with path "product" (sunbeam/textured_table.h): what is left of the
// rest over B B, one visit of the base aside, at the nodes of pairs.
#pragma once

#include "runtime/src/fit/textured_factor.h"

namespace sunbeam {
inline namespace v1 {

// Finds the values of X. What it is made of must outlive it.
class TexturedExchange {
 public:
  // `exchange` is the table's array at the base IOR of the waves, `factor` theirs and `nodes` its L.
  TexturedExchange(const NdArray& exchange, const TexturedWaves& waves, const TexturedMedia& media,
                   const TexturedFactor& factor, const std::vector<Color4>& nodes);

  // Writes X at a node of the thickness, as (direction, direction).
  void find_pairs(int d, Color4* pairs) const;

 private:
  // Names a direction of a pair by its nodes of L, which have one number.
  struct End {
    int c, p;
    std::size_t column;
  };

  std::vector<float> brackets(const NdArray& exchange, std::size_t k) const;
  void add_wavelength(int d, std::size_t k, std::vector<Rgb>& sum) const;
  Rgb one_visit(const End& a, const End& b) const;

  const TexturedWaves& waves_;
  const TexturedMedia& media_;
  const TexturedGrid& grid_;
  const TexturedFactor& factor_;
  const std::vector<Color4>& nodes_;
  std::vector<End> ends_;
  std::vector<double> below_, visit_below_;   // cosines of one visit, in the bracket and beside X
  std::vector<std::vector<float>> brackets_;  // V, each over (fringe_order, end, end)
  std::vector<std::size_t> brackets_of_;      // which of them a wavelength has
};

}  // namespace v1
}  // namespace sunbeam
