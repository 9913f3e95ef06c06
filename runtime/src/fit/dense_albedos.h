// This file estimates the directional albedo of a dense table's rest at coarse nodes. A textured table
// chooses by it between its two techniques of sampling.
#pragma once

#include <array>
#include <vector>

#include "runtime/src/base/even_axis.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

class DenseAlbedos {
 public:
  explicit DenseAlbedos(const Table& table);

  // Returns the axis of a parameter, which has its limits, in the order of kParameterNames.
  const EvenAxis& axis(std::size_t k) const { return axes_[k]; }

  // Returns the mean over channels and over the azimuth of wo; `root` is that of its cosine. Parameters lie
  // in the grid.
  float at(const Parameters& at, float root) const;

  std::size_t bytes() const { return nodes_.size() * sizeof(float); }

 private:
  std::array<EvenAxis, 3> axes_;
  std::vector<float> nodes_;  // (parameters, root of the cosine)
};

}  // namespace v1
}  // namespace sunbeam
