#include "runtime/src/lookup/bound_sampling.h"

#include "sunbeam/detail/ggx.h"

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

// Adds the row of `viewers` and returns their albedo.
double add_rest_row(const BoundValues& values, const std::vector<Vec3>& viewers, CosineRows& rows) {
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
  return rows.add_row(density);
}

struct Moments {
  double first = 0, second = 0;
  double least_cosine = 1;  // of what is drawn
};

// First and second moment over a cell, by midpoints, of f_first cos / density: R G2 / G1 times the bounded
// cap's share of the whole.
Moments first_moments(const BoundValues& values, const Ggx& normals, const Vec3& wo, std::size_t cell,
                      int nodes) {
  Moments sum;
  for (int k = 0; k < nodes * nodes; ++k) {
    const double turn = static_cast<double>(cell / FacetCells::kHeights) + (k % nodes + 0.5) / nodes;
    const double height = static_cast<double>(cell % FacetCells::kHeights) + (k / nodes + 0.5) / nodes;
    const Vec3 wi =
        normals.sample_mirrored(wo, {turn / (2 * FacetCells::kTurns), height / FacetCells::kHeights});
    sum.least_cosine = std::min(sum.least_cosine, wi.z);
    if (wi.z <= 0) continue;
    const Vec3 h = normalize(wo + wi);
    const double weight = normals.reflection(wo, wi, h) * wi.z / normals.reflection_pdf_bounded(wo, h);
    const double power = std::max(0.0, mean(values.film_reflectance(dot(wo, h)))) * weight / (nodes * nodes);
    sum.first += power;
    sum.second += power * power * (nodes * nodes);
  }
  return sum;
}

// Adds the viewer's row and returns the albedo. Cells are drawn by the root of their second moment, which
// makes the variance least; near the horizon, where light rises steeply and ends, it takes more nodes.
double add_first_row(const BoundValues& values, const Vec3& wo, FacetCells& cells) {
  constexpr int kNodes = 1, kHorizonNodes = 4;
  constexpr double kHorizon = 0.1;
  // Of the mean: neighbouring viewers may have light where this has none.
  constexpr double kLeastShare = 0.005;
  const Ggx normals(values.material.roughness);
  std::vector<double> power(FacetCells::kCells);
  double albedo = 0;
  for (std::size_t cell = 0; cell < power.size(); ++cell) {
    Moments moments = first_moments(values, normals, wo, cell, kNodes);
    if (moments.least_cosine < kHorizon) moments = first_moments(values, normals, wo, cell, kHorizonNodes);
    power[cell] = std::sqrt(moments.second);
    albedo += moments.first / FacetCells::kCells;
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
  for (int row = 0; row < kViewers; ++row) {
    const double cosine = cosine_of_root(static_cast<double>(row) / (kViewers - 1));
    const auto viewers = viewers_at(cosine, values.symmetry);
    const double of_rest = add_rest_row(values, viewers, rest);
    const double of_first =
        has_cells ? add_first_row(values, viewers[0], first) : first_albedo(values, viewers);
    const double sum = of_first + of_rest;
    first_chances.push_back(static_cast<float>(sum > 0 ? of_first / sum : 0.5));
  }
}

}  // namespace v1
}  // namespace sunbeam
