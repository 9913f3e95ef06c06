// The rest of a dense table (table.h) at one parameter point: flat arrays of single floats over the angles.
#pragma once

#include <optional>
#include <vector>

#include "runtime/src/lookup/dense_angles.h"
#include "sunbeam/table.h"

namespace sunbeam::inline v1 {

class DenseRest {
 public:
  // `material` is that of the table with the parameters of the point, which lie in the grid.
  DenseRest(const Table& table, const Material& material);

  Rgb operator()(const Vec3& wo, const Vec3& wi) const;
  Rgb standard_error(const Vec3& wo, const Vec3& wi) const;

  // Mean of the rest over the azimuth of wi, at cosines of wi.
  class AzimuthMean {
   public:
    AzimuthMean(const DenseRest& rest, const Vec3& wo);
    Rgb operator()(double cos_i) const;

   private:
    struct Node {
      double phi_i, phi_o;  // table coordinates
      double weight;        // all add up to 1
    };
    const DenseRest& rest_;
    double cos_o_;
    std::vector<Node> nodes_;
  };

 private:
  Rgb transmittance(double cosine) const;
  Rgb remainder(const AngleCoordinates& at) const {
    return to_rgb(DenseAngles::Place(*angles_, at).sum(remainder_.data()));
  }
  Rgb decoded(const Rgb& remainder, double cos_i, double cos_o) const;

  Symmetry symmetry_;
  std::optional<RestFrame> frame_;  // none: the array holds the rest itself
  bool is_full_;
  std::vector<Rgb> transmittance_;  // over even cosines
  std::optional<DenseAngles> angles_;
  std::vector<Color4> remainder_;
  NdArray stderr_;  // over the four angles
};

}  // namespace sunbeam::inline v1
