// What a table can be baked over, and what varies over a surface: the sliders of a skin.
#pragma once

#include <array>

#include "sunbeam/material.h"

namespace sunbeam::inline v1 {

// In the order of a table's axes.
inline constexpr std::array<const char*, 3> kParameterNames = {"film_thickness_nm", "base_ior",
                                                               "absorption_per_nm"};

struct Parameters {
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

}  // namespace sunbeam::inline v1
