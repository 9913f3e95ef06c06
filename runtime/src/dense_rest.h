// The rest of a dense table (table.h) at one parameter point.
#pragma once

#include <functional>
#include <vector>

#include "sunbeam/table.h"

namespace sunbeam {

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
  std::array<double, 4> coordinates(const Vec3& wo, const Vec3& wi) const;

  Symmetry symmetry_;
  RestFrame frame_;
  std::vector<Rgb> transmittance_;  // over even cosines
  NdArray remainder_, stderr_;      // over the four angles
  bool has_azimuth_;                // else they have one node each, and finding the azimuths would be in vain
};

}  // namespace sunbeam
