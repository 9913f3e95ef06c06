#include "bake/live/exact/facet_rings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "bake/live/exact/smooth_step.h"

namespace sunbeam {
namespace {

// Between edges powers are polynomials of degree 7, and so smooth is what they are multiplied with.
constexpr int kLeastNodes = 10;

// Rings for each node: a mirror may pass light in the tail of D alone.
constexpr int kRings = 3;

int ceiling(int a, int b) { return (a - 1) / b + 1; }

}  // namespace

FacetRings::Rules::Rules(int nodes)
    : panels(ceiling(kRings * nodes, GaussInterpolation::kMaxCount)),
      panel(ceiling(kRings * nodes, panels)),
      around(gauss_legendre(nodes)),
      around_peak(gauss_legendre(nodes * 3 / 2)) {
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
      tilt_(std::atan2(sine_, w.z)) {
  const double x = sine_ > 0 ? w.x / sine_ : 1, y = sine_ > 0 ? w.y / sine_ : 0;
  if (!film.roughness.is_isotropic())
    ridge_ = film.roughness.u > film.roughness.v ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  width_ = std::hypot(film.roughness.u * x, film.roughness.v * y);
  towards_ = {-x * w.z, -y * w.z, sine_};
  aside_ = {-y, x, 0};
}

// At which the ring's normals have this z; it may be out of [-1, 1].
double FacetRings::cosine_of_psi(double angle, double normal_z) const {
  const double swing = std::max(std::sin(angle) * sine_, 1e-300);
  return (normal_z - std::cos(angle) * w_.z) / swing;
}

// Where the ridge, normals tilted by `tilt` towards the axis of the larger roughness, meets rings.
double FacetRings::angle_of_ridge(double tilt) const {
  const double cosine = dot(ridge_, w_) * std::sin(tilt) + w_.z * std::cos(tilt);
  return std::acos(std::clamp(std::abs(cosine), 0.0, 1.0));
}

// A mirrored direction is above the horizon where 2 c h.z > w.z: a whole ring up to one angle, a part of it
// up to another. The ridge leaves there at two tilts.
std::vector<FacetRings::Node> FacetRings::mirroring(const Power& power) const {
  std::vector<double> angles{0, (kPi / 2 - tilt_) / 2, std::acos(film_.critical)};
  if (!film_.roughness.is_isotropic()) {
    const double tilt = std::atan2(w_.z, -dot(ridge_, w_)) / 2;
    angles.push_back(angle_of_ridge(tilt));
    angles.push_back(angle_of_ridge(tilt - kPi / 2));
  }
  angles.push_back((kPi / 2 + tilt_) / 2);
  return nodes(
      angles, [&](double angle) { return mirroring_arc(angle); }, power);
}

// A facet is seen from below the macro horizon too, h.z > 0. If light bends away from the normal, it grazes
// the base at h.z = ratio w.z / (ratio c - c2).
FacetRings::Arc FacetRings::crossing_arc(double angle) const {
  Arc arc = visible_arc(angle);
  if (film_.ratio <= 1) return arc;
  const double below = 1 - square(film_.ratio * std::sin(angle));
  const double bending = film_.ratio * std::cos(angle) - std::sqrt(std::max(0.0, below));
  arc.high = std::min(1.0, cosine_of_psi(angle, film_.ratio * w_.z / bending));
  return arc;
}

std::vector<FacetRings::Node> FacetRings::crossing(const Power& power) const {
  const double ratio = film_.ratio, rise = kPi / 2 - tilt_;
  const double end = std::acos(film_.critical);
  const double rim = ratio > 1 ? std::atan2(std::sin(rise), ratio - std::cos(rise)) : 0;
  return nodes(
      {0, rim, rise, angle_of_ridge(kPi / 2), end}, [&](double angle) { return crossing_arc(angle); }, power);
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
        const double dangle = angle_slope(x) * width * smooth_step_slope(t);
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

Vec3 FacetRings::normal(double angle, double psi) const {
  return std::cos(angle) * w_ + std::sin(angle) * (std::cos(psi) * towards_ + std::sin(psi) * aside_);
}

// F of a ring, which is a sum of waves up to the second in psi, and its derivatives.
struct FacetRings::Ring {
  Vec3 middle, along, aside;  // F = |middle + along cos(psi) + aside sin(psi)|^2

  Vec3 at(double psi) const { return middle + std::cos(psi) * along + std::sin(psi) * aside; }
  double f(double psi) const { return dot(at(psi), at(psi)); }
  Vec3 slope(double psi) const { return std::cos(psi) * aside - std::sin(psi) * along; }
  double first(double psi) const { return 2 * dot(at(psi), slope(psi)); }
  double second(double psi) const {
    return 2 * (dot(slope(psi), slope(psi)) + dot(at(psi), middle - at(psi)));
  }
};

FacetRings::Ring FacetRings::ring(double angle) const {
  const auto stretched = [&](const Vec3& h) {
    return Vec3{h.x / film_.roughness.u, h.y / film_.roughness.v, h.z};
  };
  const double sine = std::sin(angle);
  return {stretched(std::cos(angle) * w_), stretched(sine * towards_), stretched(sine * aside_)};
}

// How far from a peak towards `end`, up to which F grows, F is twice its least value.
double FacetRings::half_width(const Ring& ring, double psi, double end) {
  constexpr int kBisections = 16;
  const double twice = 2 * ring.f(psi);
  double near = psi, far = end;
  for (int k = 0; k < kBisections; ++k) {
    const double middle = (near + far) / 2;
    (ring.f(middle) < twice ? near : far) = middle;
  }
  return std::abs(far - psi);
}

// Extrema of F are known from samples to a step, and peaks of D then by Newton's method.
std::vector<FacetRings::Peak> FacetRings::peaks(double angle) const {
  constexpr int kSteps = 48, kNewtonSteps = 6;
  constexpr double kStep = 2 * kPi / kSteps;
  const Ring ring = this->ring(angle);
  std::array<double, kSteps> f;
  for (int k = 0; k < kSteps; ++k) f[k] = ring.f(k * kStep);
  const auto rises = [&](int k) { return f[(k + 1) % kSteps] > f[k % kSteps]; };
  std::vector<Peak> peaks;
  for (int k = kSteps; k < 2 * kSteps; ++k) {
    if (rises(k - 1) || !rises(k)) continue;
    int low = k - 1, high = k + 1;
    while (low > k - kSteps && !rises(low - 1)) --low;
    while (high < k + kSteps && rises(high)) ++high;
    double psi = k * kStep;
    for (int step = 0; step < kNewtonSteps; ++step) {
      const double second = ring.second(psi);
      if (second > 0) psi = std::clamp(psi - ring.first(psi) / second, (k - 1) * kStep, (k + 1) * kStep);
    }
    const double reach = std::min(half_width(ring, psi, low * kStep), half_width(ring, psi, high * kStep));
    peaks.push_back({psi, std::tan(std::min(reach, kPi / 2) / 2), low * kStep, high * kStep});
  }
  if (peaks.empty()) peaks.push_back({0, 1, -kPi, kPi});  // D is constant
  return peaks;
}

// Both halves of an isotropic film's ring are alike, and its peak is where the ring is nearest to the macro
// normal.
void FacetRings::add_ring(double angle, double weight, const Arc& arc, const Rgb& power,
                          std::vector<Node>& nodes) const {
  const double low = std::max(-1.0, arc.low), high = std::min(1.0, arc.high);
  if (low >= high) return;
  const double from = std::acos(high), to = std::acos(low);
  if (film_.roughness.is_isotropic()) {
    const Ring ring = this->ring(angle);
    const double least = ring.f(0), bend = std::max(0.0, ring.second(0));
    const Peak peak{0, std::sqrt(least / (least + 2 * bend)), -kPi, kPi};
    return add_part(angle, 2 * weight, peak, from, to, power, rules_.around, nodes);
  }
  for (const Peak& peak : peaks(angle))
    for (const double turn : {-6 * kPi, -4 * kPi, -2 * kPi, 0.0}) {
      const auto add = [&](double start, double end) {
        add_part(angle, weight, peak, std::max(peak.low, start - turn), std::min(peak.high, end - turn),
                 power, rules_.around_peak, nodes);
      };
      if (from == 0) {
        add(-to, to);
      } else {
        add(from, to);
        add(-to, -from);
      }
    }
}

void FacetRings::add_part(double angle, double weight, const Peak& peak, double low, double high,
                          const Rgb& power, const GaussRule& rule, std::vector<Node>& nodes) const {
  if (low >= high) return;
  const double sine = std::sin(angle);
  const auto coordinate_of = [&](double psi) {
    const double half = (psi - peak.psi) / 2;
    return 2 * std::atan2(std::sin(half), peak.q * std::cos(half));
  };
  const double start = coordinate_of(low), end = coordinate_of(high);
  for (int k = 0; k < rule.size(); ++k) {
    const double half = lerp(rule.node[k], start, end) / 2;
    const double psi = peak.psi + 2 * std::atan2(peak.q * std::sin(half), std::cos(half));
    const double dpsi = peak.q / (square(std::cos(half)) + square(peak.q * std::sin(half))) * (end - start);
    const Vec3 h = normal(angle, psi);
    nodes.push_back({h, ggx_.visible_pdf(w_, h) * sine * weight * dpsi * rule.weight[k], power});
  }
}

}  // namespace sunbeam
