#include "bake/live/exact/facet_rings.h"

#include <algorithm>
#include <cmath>

#include "bake/live/exact/smooth_step.h"

namespace sunbeam {
namespace {

// Powers are polynomials of degree 7 between edges.
constexpr int kLeastNodes = 8;

}  // namespace

// The peak of D follows no simple coordinate of an anisotropic film's rings.
FacetRings::Rules::Rules(int nodes, const Roughness& roughness)
    : around(gauss_legendre(roughness.is_isotropic() ? nodes : 2 * nodes)) {
  for (int count = nodes;; count /= 2) {
    rings.push_back(gauss_legendre(std::max(count, kLeastNodes)));
    if (count <= kLeastNodes) return;
  }
}

const GaussRule& FacetRings::Rules::of_width(double share) const {
  std::size_t rule = 0;
  for (double width = 0.5; share < width && rule + 1 < rings.size(); width /= 2) ++rule;
  return rings[rule];
}

FacetRings::FacetRings(const Vec3& w, const Film& film, std::span<const double> edges, const Rules& rules)
    : w_(w),
      film_(film),
      edges_(edges),
      rules_(rules),
      ggx_(film.roughness),
      sine_(std::hypot(w.x, w.y)),
      tilt_(std::atan2(sine_, w.z)),
      width_(std::sqrt(film.roughness.u * film.roughness.v)) {
  const double x = sine_ > 0 ? w.x / sine_ : 1, y = sine_ > 0 ? w.y / sine_ : 0;
  towards_ = {-x * w.z, -y * w.z, sine_};
  aside_ = {-y, x, 0};
}

// At which the ring's normals have this z; it may be out of [-1, 1].
double FacetRings::cosine_of_psi(double angle, double normal_z) const {
  const double swing = std::max(std::sin(angle) * sine_, 1e-300);
  return (normal_z - std::cos(angle) * w_.z) / swing;
}

// A mirrored direction is above the horizon where 2 c h.z > w.z: a whole ring up to one angle, a part of it
// up to another.
std::vector<FacetRings::Node> FacetRings::mirroring() const {
  const double end = (kPi / 2 + tilt_) / 2;
  return nodes({0, (kPi / 2 - tilt_) / 2, std::acos(film_.critical), end}, [&](double angle) {
    return Arc{cosine_of_psi(angle, w_.z / (2 * std::cos(angle))), 1};
  });
}

// A facet is seen from below the macro horizon too, h.z > 0. If light bends away from the normal, it grazes
// the base at h.z = ratio w.z / (ratio c - c2).
std::vector<FacetRings::Node> FacetRings::crossing() const {
  const double ratio = film_.ratio, rise = kPi / 2 - tilt_;
  const double end = std::acos(film_.critical);
  const double rim = ratio > 1 ? std::atan2(std::sin(rise), ratio - std::cos(rise)) : 0;
  return nodes({0, rim, rise, end}, [&](double angle) {
    Arc arc{cosine_of_psi(angle, 0), 1};
    if (ratio <= 1) return arc;
    const double cosine = std::cos(angle), below = 1 - square(ratio * std::sin(angle));
    const double bending = ratio * cosine - std::sqrt(std::max(0.0, below));
    arc.high = std::min(1.0, cosine_of_psi(angle, ratio * w_.z / bending));
    return arc;
  });
}

// The last of `angles` ends the rings; those between divide panels with flat ends (smooth_step.h), and edges
// of the film divide these.
template <class ArcOf>
std::vector<FacetRings::Node> FacetRings::nodes(std::vector<double> angles, ArcOf arc_of) const {
  std::vector<Node> nodes;
  const double end = angles.back();
  std::sort(angles.begin(), angles.end());
  for (std::size_t p = 0; p + 1 < angles.size() && angles[p] < end; ++p) {
    const double low = coordinate(angles[p]), high = coordinate(angles[p + 1]), panel = high - low;
    if (panel < 1e-12) continue;
    double from = 0;
    for (auto edge = edges_.rbegin(); edge != edges_.rend() && from < 1; ++edge) {
      const double x = coordinate(std::acos(*edge));
      if (x <= low) continue;
      const double to = x < high ? inverse_smooth_step((x - low) / panel) : 1;
      const GaussRule& rule = rules_.of_width(to - from);
      for (int i = 0; i < rule.size(); ++i) {
        const double t = lerp(rule.node[i], from, to), at = lerp(smooth_step(t), low, high);
        const double angle = tilt_ + width_ * std::tan(at);
        const double dangle = width_ / square(std::cos(at)) * panel * smooth_step_slope(t);
        add_ring(angle, dangle * rule.weight[i] * (to - from), arc_of(angle), nodes);
      }
      from = to;
    }
  }
  return nodes;
}

void FacetRings::add_ring(double angle, double weight, const Arc& arc, std::vector<Node>& nodes) const {
  const double low = std::max(-1.0, arc.low), high = std::min(1.0, arc.high);
  if (low >= high) return;
  const double cosine = std::cos(angle), sine = std::sin(angle);
  const double narrow = std::sqrt(std::max(0.0, 1 - square(width_)));
  const double a = 1 - narrow * cosine * w_.z, b = narrow * sine * sine_, q = std::sqrt((a - b) / (a + b));
  const auto coordinate_of = [&](double cos_psi) {
    return 2 * std::atan2(std::sqrt(1 - cos_psi), q * std::sqrt(1 + cos_psi));
  };
  const double start = coordinate_of(high), end = coordinate_of(low);
  for (int k = 0; k < rules_.around.size(); ++k) {
    const double tangent = std::tan(lerp(rules_.around.node[k], start, end) / 2);
    const double psi = 2 * std::atan(q * tangent);
    const double dpsi = q * (1 + square(tangent)) / (1 + square(q * tangent)) * (end - start);
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && film_.roughness.is_isotropic()) continue;
      const Vec3 h = cosine * w_ + sine * (std::cos(psi) * towards_ + side * std::sin(psi) * aside_);
      const double share = sine * weight * dpsi * rules_.around.weight[k];
      nodes.push_back({h, ggx_.visible_pdf(w_, h) * share * (film_.roughness.is_isotropic() ? 2 : 1)});
    }
  }
}

}  // namespace sunbeam
