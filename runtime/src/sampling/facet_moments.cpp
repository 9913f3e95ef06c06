#include "runtime/src/sampling/facet_moments.h"

#include <deque>
#include <mutex>

#include "runtime/src/sampling/facet_cells.h"
#include "sunbeam/detail/ggx.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kNodes = 1, kHorizonNodes = 4;  // each way; light rises steeply near the horizon and ends there
constexpr double kHorizon = 0.1;
constexpr std::size_t kKept = 8;  // roughnesses

struct Points {
  std::vector<FacetMoments::Node> nodes;
  double least_cosine = 1;  // of what is drawn
};

Points points_of(const Ggx& normals, const Vec3& wo, std::size_t cell, int nodes) {
  Points points;
  for (int k = 0; k < nodes * nodes; ++k) {
    const double turn = static_cast<double>(cell / FacetCells::kHeights) + (k % nodes + 0.5) / nodes;
    const double height = static_cast<double>(cell % FacetCells::kHeights) + (k / nodes + 0.5) / nodes;
    const Vec3 wi =
        normals.sample_mirrored(wo, {turn / (2 * FacetCells::kTurns), height / FacetCells::kHeights});
    points.least_cosine = std::min(points.least_cosine, wi.z);
    if (wi.z <= 0) continue;
    const Vec3 h = normalize(wo + wi);
    const double weight = normals.reflection(wo, wi, h) * wi.z / normals.reflection_pdf_bounded(wo, h);
    points.nodes.push_back({static_cast<float>(dot(wo, h)), static_cast<float>(weight)});
  }
  return points;
}

}  // namespace

FacetMoments::FacetMoments(const Roughness& roughness) {
  for (int row = 0; row < FacetCells::kRows; ++row) add_row(roughness, row);
  first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
}

void FacetMoments::add_row(const Roughness& roughness, int row) {
  const Ggx normals(roughness);
  const Vec3 wo = direction_from_cosine(FacetCells::cosine_of_row(row), 0);
  for (std::size_t cell = 0; cell < FacetCells::kCells; ++cell) {
    Points points = points_of(normals, wo, cell, kNodes);
    const bool is_near = points.least_cosine < kHorizon;
    if (is_near) points = points_of(normals, wo, cell, kHorizonNodes);
    first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    count_.push_back(is_near ? kHorizonNodes * kHorizonNodes : kNodes * kNodes);
    nodes_.insert(nodes_.end(), points.nodes.begin(), points.nodes.end());
  }
}

FacetMoments::Cell FacetMoments::cell(int row, std::size_t cell) const {
  const std::size_t k = static_cast<std::size_t>(row) * FacetCells::kCells + cell;
  return {std::span(nodes_).subspan(first_[k], first_[k + 1] - first_[k]), count_[k]};
}

std::shared_ptr<const FacetMoments> facet_moments(const Roughness& roughness) {
  struct Known {
    Roughness roughness;
    std::shared_ptr<const FacetMoments> moments;
  };
  static std::mutex mutex;
  static std::deque<Known> known;
  const std::scoped_lock lock(mutex);
  for (const Known& k : known)
    if (k.roughness == roughness) return k.moments;
  if (known.size() == kKept) known.pop_back();
  known.push_front({roughness, std::make_shared<const FacetMoments>(roughness)});
  return known.front().moments;
}

}  // namespace v1
}  // namespace sunbeam
