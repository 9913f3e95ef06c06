#include "sunbeam/detail/factors.h"

#include "sunbeam/detail/refraction.h"

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

// The square of m, below 0 beyond the critical angle, goes on as a hyperbola that bends where facets blur it:
// they turn light by their roughness, and 2 critical is the slope of it there.
double crossing_cosine(const Material& material, double cosine) {
  const double critical = critical_cosine(material.exterior_ior, material.base_ior);
  if (critical == 0 || material.is_smooth() || material.transmission == Transmission::straight)
    return arrival_cosine(material, cosine);
  const double roughness = std::max(material.roughness.u, material.roughness.v);
  const double squared = refracted_cosine_squared(material.exterior_ior, material.base_ior, cosine);
  const double rounded = (squared + std::hypot(squared, 2 * critical * roughness)) / 2;
  return std::sqrt(rounded + square(0.3 * roughness));
}

double one_visit_of_product(double optical_depth, double m_i, double m_o) {
  const double i = std::max(m_i, kLeastCosineBelow), o = std::max(m_o, kLeastCosineBelow);
  return std::exp(optical_depth * (1 - (1 / i - 1) * (1 / o - 1)));
}

}  // namespace v1
}  // namespace sunbeam
