#include "bake/factored/facets/crossing.h"

#include <algorithm>
#include <cmath>

#include "bake/live/film/geometry.h"
#include "sunbeam/detail/factors.h"
#include "sunbeam/detail/refraction.h"

namespace sunbeam {
namespace {

constexpr double kLeastMean = 1e-30;  // its logarithm is taken
constexpr double kLeastAngle = 1e-5;  // a ring has no facets at 0, and none are visible at pi/2

}  // namespace

std::vector<double> crossing_values(const Material& material, const VisibleFacets& facets,
                                    std::span<const double> cosines, std::span<const double> depths) {
  const FilmGeometry film(material);
  const double per_m = 1 / crossing_cosine(material, facets.w().z);
  const double end = std::acos(critical_cosine(film.index_ratio(), 1)) - kLeastAngle;
  std::vector<double> values(depths.size() * cosines.size());
  for (std::size_t j = 0; j < cosines.size(); ++j) {
    const double angle = std::clamp(std::acos(cosines[j]), kLeastAngle, end);
    std::vector<double> sums(depths.size());
    for (const FacetRings::Node& node : facets.rings().crossing_ring(angle))
      if (const auto inside = film.cross(facets.w(), node.normal))
        for (std::size_t t = 0; t < depths.size(); ++t)
          sums[t] += node.weight * inside->share * std::exp(-depths[t] * (1 / inside->direction.z - per_m));
    const double visible = facets.density(angle);
    for (std::size_t t = 0; t < depths.size(); ++t)
      values[t * cosines.size() + j] = std::log(std::max(sums[t] / visible, kLeastMean));
  }
  return values;
}

}  // namespace sunbeam
