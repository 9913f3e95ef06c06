// A dense table over all its parameters: its own arrays, interpolated at every look-up as bind() would.
#pragma once

#include <optional>
#include <vector>

#include "runtime/src/base/even_axis.h"
#include "runtime/src/lookup/dense_angles.h"
#include "sunbeam/table.h"

namespace sunbeam::inline v1 {

// Parameters lie in the grid, directions above the horizon.
class TexturedDense {
 public:
  explicit TexturedDense(const Table& table);

  // Limits of a parameter, in the order of kParameterNames.
  const EvenAxis& axis(std::size_t k) const { return albedo_axes_[k]; }

  // 1/sr.
  Rgb rest(const Parameters& at, const Vec3& wo, const Vec3& wi) const;
  Rgb film_reflectance(const Parameters& at, double cosine) const;

  // Estimate of the directional albedo of the rest, mean over channels and over the azimuth of wo; `root`
  // that of its cosine.
  float rest_albedo(const Parameters& at, float root) const;

  std::size_t bytes() const;

 private:
  static constexpr int kAlbedoRoots = 9;  // even roots of the cosine

  // An array over (film_thickness_nm, base_ior, cos_theta).
  class Film {
   public:
    explicit Film(const NdArray& array);
    Rgb at(const Parameters& at, double cosine) const;
    std::size_t bytes() const { return nodes_.size() * sizeof(Color4); }

   private:
    std::array<BoundAxis, 3> axes_;
    std::vector<Color4> nodes_;
  };

  Color4 remainder(const Parameters& at, const AngleCoordinates& angles) const;
  Rgb transmittance(const Parameters& at, double cosine) const;
  void find_albedos(const Table& table);

  Material material_;
  bool is_full_;
  std::optional<RestFrame> frame_;  // none: the array holds the rest itself
  Film reflectance_;
  std::optional<Film> transmittance_;
  std::array<BoundAxis, 3> axes_;  // of the parameters
  DenseAngles angles_;
  std::vector<Color4> remainder_;
  std::array<EvenAxis, 3> albedo_axes_;
  std::vector<float> albedos_;  // (parameters, root of the cosine)
};

}  // namespace sunbeam::inline v1
