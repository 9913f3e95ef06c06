// This file locates directions on the four angular axes of a dense table's remainder (table.h), and sums up
// the nodes there.
#pragma once

#include <array>

#include "runtime/src/base/bound_axis.h"
#include "runtime/src/base/color4.h"
#include "sunbeam/detail/angles.h"
#include "sunbeam/detail/nd_array.h"

namespace sunbeam {
inline namespace v1 {

class DenseAngles {
 public:
  // Takes the last four axes of `remainder`.
  DenseAngles(const NdArray& remainder, Symmetry symmetry) : symmetry_(symmetry) {
    const std::size_t first = remainder.axes().size() - 4;
    for (std::size_t k = 0; k < 4; ++k) {
      axes_[k] = remainder.axes()[first + k];
      bound_[k] = BoundAxis(axes_[k], remainder.stride(first + k));
    }
    has_azimuth_ = axes_[1].size() > 1 || axes_[3].size() > 1;
  }

  const Axis& axis(std::size_t k) const { return axes_[k]; }

  AngleCoordinates coordinates(const Vec3& wo, const Vec3& wi) const {
    if (!has_azimuth_) return {wi.z, 0, wo.z, 0};
    return to_coordinates(symmetry_, {wo, wi});
  }

  class Place {
   public:
    Place(const DenseAngles& angles, const AngleCoordinates& at)
        : i_(angles.bound_[0].at(at.cos_i)), o_(angles.bound_[2].at(at.cos_o)) {
      if (!angles.has_azimuth_) return;
      phi_i_ = angles.bound_[1].at(at.phi_i);
      phi_o_ = angles.bound_[3].at(at.phi_o);
    }

    // Sums up `cells`, those of one node of the parameters.
    Color4 sum(const Color4* cells) const {
      Color4 sum{};
      for (int a = 0; a < i_.count; ++a)
        for (int b = 0; b < phi_i_.count; ++b) {
          const Color4* block = cells + i_.offset[a] + phi_i_.offset[b];
          Color4 of_block{};
          for (int c = 0; c < o_.count; ++c) of_block += o_.weight[c] * over_phi_o(block + o_.offset[c]);
          sum += i_.weight[a] * phi_i_.weight[b] * of_block;
        }
      return sum;
    }

   private:
    Color4 over_phi_o(const Color4* row) const {
      Color4 sum{};
      for (int d = 0; d < phi_o_.count; ++d) sum += phi_o_.weight[d] * row[phi_o_.offset[d]];
      return sum;
    }

    BoundAxis::Taps i_, o_, phi_i_{1, {}, {1}}, phi_o_{1, {}, {1}};
  };

 private:
  Symmetry symmetry_;
  std::array<Axis, 4> axes_;
  std::array<BoundAxis, 4> bound_;
  bool has_azimuth_;  // else those axes have one node each, and finding the azimuths would be in vain
};

}  // namespace v1
}  // namespace sunbeam
