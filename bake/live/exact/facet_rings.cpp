#include "bake/live/exact/facet_rings.h"

#include <algorithm>
#include <cmath>

#include "bake/live/exact/smooth_step.h"

namespace sunbeam {
namespace {

// Between edges powers are polynomials of degree 7, and so smooth is what they are multiplied with.
constexpr int kLeastNodes = 10;

// Rings for each node: a mirror may pass light in the tail of D alone.
constexpr int kRings = 3;

int ceiling(int a, int b) { return (a - 1) / b + 1; }

// Nodes around for each node: the peak of D follows no simple coordinate of an anisotropic film's rings.
int around_for(const Roughness& roughness) {
  const auto [low, high] = std::minmax(roughness.u, roughness.v);
  return static_cast<int>(std::ceil(std::sqrt(high / low)));
}

}  // namespace

FacetRings::Rules::Rules(int nodes, const Roughness& roughness)
    : panels(ceiling(kRings * nodes, GaussInterpolation::kMaxCount)),
      panel(ceiling(kRings * nodes, panels)),
      around(gauss_legendre(nodes * around_for(roughness))) {
  for (int count = nodes;; count /= 2) {
    film.push_back(gauss_legendre(std::max(count, kLeastNodes)));
    if (count <= kLeastNodes) return;
  }
}

const GaussRule& FacetRings::Rules::of_width(double share) const {
  std::size_t rule = 0;
  for (double width = 0.5; share < width && rule + 1 < film.size(); width /= 2) ++rule;
  return film[rule];
}

double FacetRings::Panel::at(double t) const { return low + width * smooth_step(t); }

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
std::vector<FacetRings::Node> FacetRings::mirroring(const Power& power) const {
  const double end = (kPi / 2 + tilt_) / 2;
  return nodes(
      {0, (kPi / 2 - tilt_) / 2, std::acos(film_.critical), end},
      [&](double angle) {
        return Arc{cosine_of_psi(angle, w_.z / (2 * std::cos(angle))), 1};
      },
      power);
}

// A facet is seen from below the macro horizon too, h.z > 0. If light bends away from the normal, it grazes
// the base at h.z = ratio w.z / (ratio c - c2).
std::vector<FacetRings::Node> FacetRings::crossing(const Power& power) const {
  const double ratio = film_.ratio, rise = kPi / 2 - tilt_;
  const double end = std::acos(film_.critical);
  const double rim = ratio > 1 ? std::atan2(std::sin(rise), ratio - std::cos(rise)) : 0;
  return nodes(
      {0, rim, rise, end},
      [&](double angle) {
        Arc arc{cosine_of_psi(angle, 0), 1};
        if (ratio <= 1) return arc;
        const double cosine = std::cos(angle), below = 1 - square(ratio * std::sin(angle));
        const double bending = ratio * cosine - std::sqrt(std::max(0.0, below));
        arc.high = std::min(1.0, cosine_of_psi(angle, ratio * w_.z / bending));
        return arc;
      },
      power);
}

// The last of `angles` ends the rings; the others divide panels with flat ends (smooth_step.h).
template <class ArcOf>
std::vector<FacetRings::Node> FacetRings::nodes(std::vector<double> angles, ArcOf arc_of,
                                                const Power& power) const {
  std::vector<Node> nodes;
  const double end = angles.back();
  std::sort(angles.begin(), angles.end());
  for (std::size_t p = 0; p + 1 < angles.size() && angles[p] < end; ++p) {
    const double low = coordinate(angles[p]), width = coordinate(angles[p + 1]) - low;
    if (width < 1e-12) continue;
    for (int part = 0; part < rules_.panels; ++part) {
      const double parts = rules_.panels;
      const Panel panel{low, width, part / parts, (part + 1) / parts};
      const std::vector<Rgb> power_moments = moments(panel, power);
      for (int j = 0; j < rules_.panel.size(); ++j) {
        const double t = lerp(rules_.panel.rule().node[j], panel.from, panel.to), x = panel.at(t);
        const double dangle = width_ / square(std::cos(x)) * width * smooth_step_slope(t);
        add_ring(angle_at(x), dangle, arc_of(angle_at(x)), power_moments[j], nodes);
      }
    }
  }
  return nodes;
}

// Int power L_j dt of a panel's nodes: the film's oscillations are integrated here, between its edges, and
// what multiplies them only has to be smooth.
std::vector<Rgb> FacetRings::moments(const Panel& panel, const Power& power) const {
  std::vector<Rgb> moments(rules_.panel.size());
  const double whole = panel.to - panel.from;
  double from = panel.from;
  for (auto edge = edges_.rbegin(); edge != edges_.rend() && from < panel.to; ++edge) {
    const double x = (coordinate(std::acos(*edge)) - panel.low) / panel.width;
    const double to = std::min(panel.to, x < 1 ? inverse_smooth_step(std::max(0.0, x)) : 1);
    if (to <= from) continue;
    const GaussRule& rule = rules_.of_width((to - from) / whole);
    for (int i = 0; i < rule.size(); ++i) {
      const double t = lerp(rule.node[i], from, to);
      const Rgb value = power(std::cos(angle_at(panel.at(t)))) * (rule.weight[i] * (to - from));
      const auto weights = rules_.panel.at((t - panel.from) / whole);
      for (int j = 0; j < rules_.panel.size(); ++j) moments[j] += value * weights[j];
    }
    from = to;
  }
  return moments;
}

void FacetRings::add_ring(double angle, double weight, const Arc& arc, const Rgb& power,
                          std::vector<Node>& nodes) const {
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
      nodes.push_back({h, ggx_.visible_pdf(w_, h) * share * (film_.roughness.is_isotropic() ? 2 : 1), power});
    }
  }
}

}  // namespace sunbeam
