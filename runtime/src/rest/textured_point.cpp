#include "sunbeam/detail/textured_point.h"

#include "sunbeam/detail/factor_frame.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastFrame = 0.05, kLeastSmoothFrame = 1e-3, kLeastWarpedFrame = 0.3;  // of m~

}  // namespace

double textured_path(const Material& material, double cosine) {
  return material.is_smooth() ? 1 : fringe_order(material, cosine) / fringe_order(material, 1);
}

FilmCosines::FilmCosines(const Material& material, bool is_warped)
    : softness(static_cast<float>(critical_axis(material).softness)),
      bends(material.transmission == Transmission::refract),
      is_warped(is_warped),
      exterior_ior(material.exterior_ior),
      pigment_thickness_nm(material.pigment_thickness_nm) {
  const double blur2 = square(0.3 * std::max(material.roughness.u, material.roughness.v));
  film_scale = static_cast<float>(1 / (1 + blur2));
  film_offset = static_cast<float>(blur2 / (1 + blur2));
  path_scale =
      material.is_smooth() ? 0 : static_cast<float>(square(material.exterior_ior / material.film_ior));
  path_offset = 1 - path_scale;
  least_path = static_cast<float>(square(textured_path(material, 0)));
  const bool bends_warped = is_warped && bends;
  const double least_frame = material.is_smooth() ? kLeastSmoothFrame
                             : bends_warped       ? kLeastWarpedFrame
                                                  : std::max(std::sqrt(blur2), kLeastFrame);
  least_below = static_cast<float>(square(least_frame));
  visit_blur2 = bends_warped ? softness * softness : 0;
}

PigmentCosines::PigmentCosines(const FilmCosines& material, double base_ior, double depth)
    : least_below(material.least_below),
      visit_blur2(material.visit_blur2),
      optical_depth(static_cast<float>(depth)) {
  const double ratio2 = material.bends ? square(material.exterior_ior / base_ior) : 1;
  below_scale = static_cast<float>(ratio2);
  below_offset = static_cast<float>(1 - ratio2);
  if (material.is_warped) take_warp(material, base_ior);
}

void PigmentCosines::take_warp(const FilmCosines& material, double base_ior) {
  const double ratio = std::min(base_ior / material.exterior_ior, 1.0), knee = std::sqrt(1 - ratio * ratio);
  const auto u = [&](double cosine) {
    return (cosine - knee) / std::sqrt(std::abs(cosine - knee) + double{material.softness});
  };
  const double first = u(kLowestArrayCosine), per = 1 / (u(1) - first);
  critical = static_cast<float>(knee);
  softness = material.softness;
  per_extent = static_cast<float>(per);
  first_warped = static_cast<float>(first * per);
}

}  // namespace v1
}  // namespace sunbeam
