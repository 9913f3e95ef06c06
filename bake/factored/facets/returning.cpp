#include "bake/factored/facets/returning.h"

#include <algorithm>
#include <cmath>

#include "bake/factored/facets/facet_shares.h"
#include "bake/live/film/geometry.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {
namespace {

constexpr int kCells = 128;   // of the angle between light and facet
constexpr int kAzimuths = 8;  // of light under an anisotropic film, in a quadrant
constexpr double kLeastAngle = 1e-5;

// The base's directions, by its cosine law, and their weights.
struct Diffuse {
  explicit Diffuse(const Roughness& roughness) {
    const double width = std::min(roughness.u, roughness.v);
    const GaussRule rule = gauss_legendre(std::clamp(static_cast<int>(6 / width), 64, 512));
    const int azimuths = roughness.is_isotropic() ? 1 : kAzimuths;
    for (int i = 0; i < rule.size(); ++i)
      for (int a = 0; a < azimuths; ++a) {
        const double phi = azimuths == 1 ? 0 : kPi / 2 * (a + 0.5) / azimuths;
        directions.emplace_back(direction_from_cosine(std::sqrt(rule.node[i]), phi), roughness, 1);
        weights.push_back(rule.weight[i] / azimuths);
      }
  }

  double density(double angle) const {
    double sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * directions[k].density(angle);
    return sum;
  }

  std::vector<VisibleFacets> directions;
  std::vector<double> weights;
};

Returning smooth(std::span<const double> ranks, std::span<const double> depths) {
  Returning result;
  for (const double rank : ranks) result.cosines.push_back(std::sqrt(share_of_rank(rank)));
  for (const double depth : depths)
    for (const double cosine : result.cosines)
      result.values.push_back(depth > 0 ? std::exp(-2 * depth / std::max(cosine, 1e-6)) : 1);
  return result;
}

// Adds to each optical depth what of the light along one direction comes back from a ring of facets.
void add_mirrored(const FilmGeometry& film, const VisibleFacets& facets, double angle, double weight,
                  std::span<const double> depths, std::span<double> sums) {
  for (const FacetRings::Node& node : facets.rings().mirroring_ring(angle))
    if (const auto down = film.mirror(facets.w(), node.normal)) {
      const double path = 1 / facets.w().z + 1 / down->direction.z;
      for (std::size_t t = 0; t < depths.size(); ++t)
        sums[t] += weight * node.weight * down->share * std::exp(-depths[t] * path);
    }
}

}  // namespace

Returning returning_of(const Material& material, std::span<const double> ranks,
                       std::span<const double> depths) {
  if (material.is_smooth()) return smooth(ranks, depths);
  const Diffuse diffuse(material.roughness);
  const ShareOfInterval share_of(0, kPi / 2, kCells, [&](double angle) { return diffuse.density(angle); });
  const FilmGeometry film(material);
  Returning result;
  result.values.resize(depths.size() * ranks.size());
  for (std::size_t j = 0; j < ranks.size(); ++j) {
    const double angle =
        std::clamp(share_of.above(share_of_rank(ranks[j])), kLeastAngle, kPi / 2 - kLeastAngle);
    result.cosines.push_back(std::cos(angle));
    std::vector<double> sums(depths.size());
    for (std::size_t k = 0; k < diffuse.weights.size(); ++k)
      add_mirrored(film, diffuse.directions[k], angle, diffuse.weights[k], depths, sums);
    const double met = diffuse.density(angle);
    for (std::size_t t = 0; t < depths.size(); ++t)
      result.values[t * ranks.size() + j] = std::min(sums[t] / met, 1.0);
  }
  return result;
}

}  // namespace sunbeam
