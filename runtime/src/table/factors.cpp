#include "sunbeam/detail/factors.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// Refraction into a film of lower index may have no cosine; the order only has to go on smoothly.
constexpr double kLeastFilmCosine2 = 0.04;
constexpr double kLeastCosineBelow = 1e-6;

}  // namespace

double fringe_order(const Material& material, double cosine) {
  const double ratio = material.exterior_ior / material.film_ior;
  return 2 * material.film_ior *
         std::sqrt(std::max(1 - ratio * ratio * (1 - cosine * cosine), kLeastFilmCosine2));
}

double arrival_cosine(const Material& material, double cosine) {
  const double below = std::max(material.cosine_below(cosine), kLeastCosineBelow);
  if (material.is_smooth() || material.transmission == Transmission::straight) return below;
  return std::hypot(below, 0.3 * std::max(material.roughness.u, material.roughness.v));
}

double one_visit_of_product(double optical_depth, double m_i, double m_o) {
  const double i = std::max(m_i, kLeastCosineBelow), o = std::max(m_o, kLeastCosineBelow);
  return std::exp(optical_depth * (1 - (1 / i - 1) * (1 / o - 1)));
}

}  // namespace v1
}  // namespace sunbeam
