// This file lists the parameter nodes of a dense table and turns the rest at one of them into values of the
// table's arrays.
#pragma once

#include <optional>

#include "bake/blocks/job.h"
#include "bake/dense/equal_cells.h"
#include "bake/recipe/recipe.h"
#include "sunbeam/detail/rest_frame.h"
#include "sunbeam/table.h"

namespace sunbeam {

// Returns the axes of a dense table's remainder.
std::vector<Axis> rest_axes(const Recipe& recipe);

class DenseNodes {
 public:
  explicit DenseNodes(const Recipe& recipe);

  std::size_t size() const { return size_; }
  Parameters parameters(std::size_t node) const;
  Material material(std::size_t node) const { return parameters(node).applied_to(recipe_.material); }

  // These are the directions of a row (wi) and of the places in it (wo), with the cosines of both and the
  // azimuths of wo.
  const std::vector<Vec3>& wi() const { return wi_; }
  const std::vector<Vec3>& wo() const { return wo_; }
  const std::vector<double>& cosines() const { return remainder_.axes()[3].nodes; }
  const std::vector<double>& azimuths() const { return remainder_.axes()[6].nodes; }
  std::size_t cells() const { return wi_.size() * wo_.size(); }

  // These return the table without `info`, `remainder` and `rest_stderr`, and the shapes of these two arrays.
  const Table& head() const { return head_; }
  const ArrayShape& remainder_shape() const { return remainder_; }
  const ArrayShape& rest_stderr_shape() const { return rest_stderr_; }

  // These return what the arrays hold of a node, made from its rest and from the rest's standard error.
  std::vector<float> remainder(std::size_t node, Rows rest) const;
  std::vector<float> rest_stderr(Rows errors) const;

 private:
  void frame(std::size_t node, Rows& rest) const;

  const Recipe& recipe_;
  Table head_;
  ArrayShape remainder_, rest_stderr_;
  std::vector<Vec3> wi_, wo_;
  std::size_t size_;
  EqualCells equal_cells_;
  std::optional<RestFrame> frame_;
};

}  // namespace sunbeam
