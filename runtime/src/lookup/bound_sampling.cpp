#include "runtime/src/lookup/bound_sampling.h"

#include "runtime/src/sampling/facet_moments.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kViewerAzimuths = 4;     // of wo in a quadrant, which sampling data are averaged over
constexpr int kNormalNodes = 16;       // of an albedo's quadrature over visible normals, each way
constexpr double kLeastCosine = 1e-4;  // of a node at grazing

double cosine_of_root(double root) { return std::max(root * root, kLeastCosine); }

// Directions of one cosine, one an azimuth of an anisotropic film's quadrant.
std::vector<Vec3> viewers_at(double cosine, Symmetry symmetry) {
  if (symmetry == Symmetry::isotropic) return {direction_from_cosine(cosine, 0)};
  std::vector<Vec3> viewers;
  for (int a = 0; a < kViewerAzimuths; ++a)
    viewers.push_back(direction_from_cosine(cosine, kPi / 2 * (a + 0.5) / kViewerAzimuths));
  return viewers;
}

// The density of the rest over the root of the light's cosine at the nodes of CosineRows, in any unit.
std::vector<double> rest_density(const BoundValues& values, const std::vector<Vec3>& viewers) {
  std::vector<double> density(CosineRows::kNodes);
  for (const Vec3& wo : viewers)
    values.visit_azimuth_mean(wo, [&](const BoundValues::OfCosine& mean_rest) {
      for (int node = 0; node < CosineRows::kNodes; ++node) {
        const double root = CosineRows::root_of_node(node), cos_i = cosine_of_root(root);
        // f cos dwi = f cos 2 pi dcos, dcos = 2 root droot.
        density[static_cast<std::size_t>(node)] +=
            std::max(0.0, mean(mean_rest(cos_i)) * cos_i * 4 * kPi * root) /
            static_cast<double>(viewers.size());
      }
    });
  return density;
}

// The film's reflectance, mean over channels, at the cosines of BoundValues::film.
std::vector<float> mean_film(const BoundValues& values) {
  std::vector<float> means;
  for (std::size_t k = 0; k <= values.film.size(); ++k) {
    const Color4 r = values.film.get(k);
    means.push_back(std::max((r[0] + r[1] + r[2]) / 3, 0.0f));
  }
  return means;
}

// Adds the viewer's row and returns the albedo. Cells are drawn by the root of their second moment, which
// makes the variance least.
double add_first_row(const std::vector<float>& film, const FacetMoments& moments, int row,
                     FacetCells& cells) {
  constexpr double kLeastShare = 0.005;  // of the mean: neighbours may have light where this viewer has none
  std::array<double, FacetCells::kCells> power;
  double albedo = 0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    const FacetMoments::Cell cell = moments.cell(row, k);
    float first = 0, second = 0;
    for (const FacetMoments::Node& node : cell.nodes) {
      const float of_node =
          lerp(film.data(), EvenPosition(node.cosine, BoundValues::kFilmCosines)) * node.weight;
      first += of_node;
      second += of_node * of_node;
    }
    const auto count = static_cast<float>(cell.count);
    power[k] = double{std::sqrt(second / count)};
    albedo += double{first / (count * FacetCells::kCells)};
  }
  for (double& p : power) p = std::max(p, kLeastShare * albedo);
  cells.add_row(power);
  return albedo;
}

double first_albedo(const BoundValues& values, const std::vector<Vec3>& viewers) {
  double sum = 0;
  for (const Vec3& wo : viewers)
    sum += std::max(0.0, mean(values.first_albedo(wo, kNormalNodes))) / static_cast<double>(viewers.size());
  return sum;
}

}  // namespace

BoundSampling::BoundSampling(const BoundValues& values) {
  const bool has_cells = !values.material.is_smooth() && values.material.roughness.is_isotropic();
  const auto moments = has_cells ? facet_moments(values.material.roughness) : nullptr;
  const std::vector<float> film = mean_film(values);
  for (int row = 0; row < kViewers; ++row) {
    const auto viewers = viewers_at(FacetCells::cosine_of_row(row), values.symmetry);
    std::vector<double> density = rest_density(values, viewers);
    const double of_rest = rest.add_row(density);
    rest_densities.insert(rest_densities.end(), density.begin(), density.end());
    const double of_first =
        has_cells ? add_first_row(film, *moments, row, first) : first_albedo(values, viewers);
    const double sum = of_first + of_rest;
    first_chances.push_back(static_cast<float>(sum > 0 ? of_first / sum : 0.5));
  }
}

}  // namespace v1
}  // namespace sunbeam
