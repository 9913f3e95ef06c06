#include "sunbeam/detail/textured_point.h"

#include "sunbeam/detail/factors.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastFrame = 0.05, kLeastSmoothFrame = 1e-3;  // of m~

}  // namespace

double textured_path(const Material& material, double cosine) {
  return material.is_smooth() ? 1 : fringe_order(material, cosine) / fringe_order(material, 1);
}

FilmCosines::FilmCosines(const Material& material)
    : bends(material.transmission == Transmission::refract),
      exterior_ior(material.exterior_ior),
      pigment_thickness_nm(material.pigment_thickness_nm) {
  const double blur2 = square(0.3 * std::max(material.roughness.u, material.roughness.v));
  film_scale = static_cast<float>(1 / (1 + blur2));
  film_offset = static_cast<float>(blur2 / (1 + blur2));
  path_scale =
      material.is_smooth() ? 0 : static_cast<float>(square(material.exterior_ior / material.film_ior));
  path_offset = 1 - path_scale;
  least_path = static_cast<float>(square(textured_path(material, 0)));
  least_below = static_cast<float>(
      square(material.is_smooth() ? kLeastSmoothFrame : std::max(std::sqrt(blur2), kLeastFrame)));
}

PigmentCosines::PigmentCosines(const FilmCosines& material, double base_ior, double depth)
    : least_below(material.least_below), optical_depth(static_cast<float>(depth)) {
  const double ratio2 = material.bends ? square(material.exterior_ior / base_ior) : 1;
  below_scale = static_cast<float>(ratio2);
  below_offset = static_cast<float>(1 - ratio2);
}

}  // namespace v1
}  // namespace sunbeam
