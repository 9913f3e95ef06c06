// This file looks up the rest of a dense table (sunbeam/table.h). It holds flat arrays of single floats over
// the angles, at one parameter point or over all of them. bake/dense/nodes.h makes the arrays;
// sunbeam/detail/rest_frame.h decodes them.
#pragma once

#include <optional>
#include <vector>

#include "runtime/src/rest/dense_angles.h"
#include "sunbeam/detail/rest_frame.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

// These are the axes (film_thickness_nm, base_ior, absorption_per_nm) or (film_thickness_nm, base_ior,
// cos_theta).
using ThreeAxes = std::array<BoundAxis, 3>;

// Interpolates an array over (film_thickness_nm, base_ior, cos_theta).
class DenseFilm {
 public:
  explicit DenseFilm(const NdArray& array);
  Rgb at(const Parameters& at, double cosine) const;
  std::size_t bytes() const { return nodes_.size() * sizeof(Color4); }

 private:
  ThreeAxes axes_;
  std::vector<Color4> nodes_;
};

// Looks the rest up. Directions lie above the horizon.
class DenseRest {
 public:
  // Serves the whole table: its own arrays are interpolated at every look-up.
  explicit DenseRest(const Table& table);
  // Serves the parameters of `material`, which lie in the grid: the arrays are sliced. What parameters
  // look-ups are given is then of no matter.
  DenseRest(const Table& table, const Material& material);

  // Returns the rest, 1/sr.
  Rgb rest(const Parameters& at, const Vec3& wo, const Vec3& wi) const;
  // Returns the standard error of the rest, 1/sr, of a table at one point.
  Rgb standard_error(const Vec3& wo, const Vec3& wi) const;

  // Returns the mean of the rest over the azimuth of wi, at cosines of wi.
  class AzimuthMean {
   public:
    AzimuthMean(const DenseRest& rest, const Parameters& at, const Vec3& wo);
    Rgb operator()(double cos_i) const;

   private:
    struct Node {
      double phi_i, phi_o;  // table coordinates
      double weight;        // all add up to 1
    };
    const DenseRest& rest_;
    Parameters at_;
    double cos_o_;
    std::vector<Node> nodes_;
  };

  // Returns the film's reflectance. Only a rest over all points has it.
  const DenseFilm& reflectance() const { return *reflectance_; }

  std::size_t bytes() const;

 private:
  Rgb transmittance(const Parameters& at, double cosine) const;  // of all points
  Rgb transmittance(double cosine) const;                        // of one point
  Rgb remainder(const Parameters& at, const AngleCoordinates& angles) const;
  Rgb decoded(const Parameters& at, const Rgb& remainder, double cos_i, double cos_o) const;

  Material material_;
  Symmetry symmetry_;
  bool is_full_;
  std::optional<RestFrame> frame_;  // none: the array holds the rest itself
  std::optional<DenseAngles> angles_;
  std::vector<Color4> remainder_;

  // A rest over all points has these.
  std::optional<ThreeAxes> axes_;
  std::optional<DenseFilm> reflectance_, transmittance_;

  // A rest at one point has these.
  std::vector<Rgb> transmittances_;  // over even cosines
  NdArray stderr_;                   // over the four angles
};

}  // namespace v1
}  // namespace sunbeam
