#include "bake/factored/facets/facet_shares.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sunbeam/detail/factors.h"

namespace sunbeam {
namespace {

constexpr int kCells = 128;        // of the angle's coordinate
constexpr int kNodesOfARing = 32;  // half of it, or a peak of an anisotropic film's

const FacetRings::Rules& rules() {
  static const FacetRings::Rules rules(kNodesOfARing);
  return rules;
}

// Cubic Hermite polynomial of values and slopes at both ends of [0, 1].
double hermite(double t, double f0, double f1, double s0, double s1) {
  const double u = 1 - t;
  return u * u * (1 + 2 * t) * f0 + t * t * (3 - 2 * t) * f1 + t * u * (u * s0 - t * s1);
}

}  // namespace

ShareOfInterval::ShareOfInterval(double low, double high, int cells,
                                 const std::function<double(double x)>& density)
    : low_(low), step_((high - low) / cells), below_{0} {
  for (int k = 0; k <= cells; ++k) density_.push_back(density(low + k * step_));
  for (std::size_t k = 0; k + 1 < density_.size(); ++k) {
    const double middle = density(low + (static_cast<double>(k) + 0.5) * step_);
    below_.push_back(below_.back() + step_ / 6 * (density_[k] + 4 * middle + density_[k + 1]));
  }
  const double whole = below_.back();
  for (double& share : below_) share /= whole;
  for (double& slope : density_) slope *= step_ / whole;
}

double ShareOfInterval::above(double share) const {
  constexpr int kBisections = 50;
  const double below = std::clamp(1 - share, 0.0, 1.0);
  const auto upper = std::upper_bound(below_.begin() + 1, below_.end() - 1, below);
  const auto k = static_cast<std::size_t>(upper - below_.begin()) - 1;
  double from = 0, to = 1;
  for (int i = 0; i < kBisections; ++i) {
    const double t = (from + to) / 2;
    const double found = hermite(t, below_[k], below_[k + 1], density_[k], density_[k + 1]);
    (found < below ? from : to) = t;
  }
  return low_ + (static_cast<double>(k) + (from + to) / 2) * step_;
}

VisibleFacets::VisibleFacets(const Vec3& w, const Roughness& roughness, double ratio)
    : w_(roughness.is_isotropic() ? direction_from_cosine(w.z, 0) : w),
      rings_(w_, {roughness, ratio, 0}, {}, rules()) {}

double VisibleFacets::density(double angle) const {
  double sum = 0;
  for (const FacetRings::Node& node : rings_.visible_ring(angle)) sum += node.weight;
  return sum;
}

// The angle falls as the cosine grows, so shares count from its other end.
std::vector<double> VisibleFacets::cosines(std::span<const double> ranks) const {
  const double low = rings_.coordinate(0), high = rings_.coordinate(kPi / 2);
  const ShareOfInterval share_of(low, high, kCells, [&](double x) {
    return density(std::max(rings_.angle_at(x), 0.0)) * rings_.angle_slope(x);
  });
  std::vector<double> cosines;
  for (const double rank : ranks)
    cosines.push_back(std::clamp(std::cos(rings_.angle_at(share_of.above(share_of_rank(rank)))), 0.0, 1.0));
  return cosines;
}

}  // namespace sunbeam
