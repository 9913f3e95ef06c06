// This is what the cells of FacetCells weigh but for the film: how much light of a viewer facets throw along
// the directions of a cell, and at which cosine they meet it. It depends on the roughness alone.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sunbeam/detail/roughness.h"

namespace sunbeam {
inline namespace v1 {

class FacetMoments {
 public:
  explicit FacetMoments(const Roughness& roughness);

  // Holds midpoints of a cell: the cosine c between light and normal, and the weight G2 / G1 times the
  // bounded cap's share of the whole.
  struct Node {
    float cosine, weight;
  };
  // Returns the midpoints of a cell that lie above the horizon; `count` is the number of all of them.
  struct Cell {
    std::span<const Node> nodes;
    int count;
  };
  Cell cell(int row, std::size_t cell) const;

 private:
  void add_row(const Roughness& roughness, int row);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> first_;  // node of each cell, row by row, and the end
  std::vector<std::uint8_t> count_;
};

// Returns those of a roughness, which the last few callers share. Any number of threads may call it.
std::shared_ptr<const FacetMoments> facet_moments(const Roughness& roughness);

}  // namespace v1
}  // namespace sunbeam
