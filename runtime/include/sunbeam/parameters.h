// The three parameters that a table is baked over and that a surface may vary: the sliders of a skin.
#pragma once

#include <array>

#include "sunbeam/core/export.h"
#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// The names of the parameters, in the order of a table's axes.
inline constexpr std::array<const char*, 3> kParameterNames = {"film_thickness_nm", "base_ior",
                                                               "absorption_per_nm"};

// One point of the grid or between its nodes: nm, no unit, 1/nm.
struct SUNBEAM_EXPORT Parameters {
  double film_thickness_nm, base_ior, absorption_per_nm;

  static Parameters of(const Material& material) {
    return {material.film_thickness_nm, material.base_ior, material.absorption_per_nm};
  }
  Material applied_to(Material material) const {
    material.film_thickness_nm = film_thickness_nm;
    material.base_ior = base_ior;
    material.absorption_per_nm = absorption_per_nm;
    return material;
  }
  std::array<double, 3> values() const { return {film_thickness_nm, base_ior, absorption_per_nm}; }
};

}  // namespace v1
}  // namespace sunbeam
