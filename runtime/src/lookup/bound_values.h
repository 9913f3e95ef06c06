// This file holds the values of a table at one parameter point: what the film reflects, the rest, and the
// albedos of both. BoundTable looks directions up in them and samples them.
#pragma once

#include <functional>
#include <variant>
#include <vector>

#include "runtime/src/rest/color_nodes.h"
#include "runtime/src/rest/dense_rest.h"
#include "runtime/src/rest/separable.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

struct BoundValues {
  // `material` is that of the table with the parameters of the point, which lie in the grid.
  BoundValues(const Table& table, const Material& material, const BindOptions& options);

  static constexpr int kFilmCosines = 881;

  // An isotropic factored table's rest is in `separable`, and the variant is empty.
  bool is_separable() const { return std::holds_alternative<std::monostate>(other); }

  // Returns the rest, 1/sr, of directions above the horizon, in a table that is not separable.
  Rgb other_rest(const Vec3& wo, const Vec3& wi) const;
  Rgb film_reflectance(double cosine) const;

  // Calls `visit` with the mean of the rest over the azimuth of wi, which is a function of the cosine of wi.
  using OfCosine = std::function<Rgb(double cos_i)>;
  void visit_azimuth_mean(const Vec3& wo, const std::function<void(const OfCosine&)>& visit) const;

  // Returns Int f_first cos dwi, the Dirac of a smooth film included, with `nodes` visible normals each way.
  Rgb first_albedo(const Vec3& wo, int nodes) const;
  // Returns Int f_rest cos dwi.
  Rgb rest_albedo(const Vec3& wo) const;

  std::size_t bytes() const;

  Material material;
  Symmetry symmetry;
  ColorMatrix to;                 // from the colours of the table to those of all values here
  double noise = 0;               // relative standard error of a factored rest
  ColorNodes film{kFilmCosines};  // reflectance at even cosines
  Separable separable;
  std::variant<std::monostate, DenseRest, AnisotropicSeparable> other;
};

}  // namespace v1
}  // namespace sunbeam
