// This file makes X of a textured table whose film is layered (sunbeam/textured_table.h): the rest over B B
// at pairs of directions, one visit of the base aside with path "product".
#pragma once

#include "runtime/src/textured/layered_factor.h"

namespace sunbeam {
inline namespace v1 {

class LayeredPairs {
 public:
  // `factor` is that of the point. What it is made of must outlive it.
  LayeredPairs(const Table& table, const LayeredGrid& grid, const LayeredFactor& factor);

  // Writes X as (end, end).
  void take(Color4* pairs) const;

 private:
  void add_wavelength(std::size_t k, std::vector<Rgb>& sum) const;
  std::vector<double> brackets(std::size_t k) const;
  Rgb one_visit(int a, int b) const;
  double order(std::size_t k) const;

  const Table& table_;
  const LayeredFactor& factor_;
  const LayeredGrid& grid_;
  std::vector<int> columns_;                     // of each end
  std::vector<double> below_;                    // cosine of one visit at each end, in the bracket
  std::vector<std::vector<DirectionTap>> taps_;  // of each end in `exchange`
};

}  // namespace v1
}  // namespace sunbeam
