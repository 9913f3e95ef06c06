#include "runtime/tracer/snake.h"

#include <algorithm>
#include <span>

namespace sunbeam {
namespace {

// Lengths in body radii from here on. Distances along the body are from the tip of the tail ("arc") or from
// the snout ("back").
constexpr double kHeadLength = 3.5;
constexpr double kNeckLength = 9;      // over which the body thins towards the head
constexpr double kTailFraction = 0.5;  // of the whole, over which it thins towards the tip

constexpr double kTipLength = 0.15;  // of the tail, rounded

// --- the centreline: a uniform cubic B-spline ---

class Spline {
 public:
  explicit Spline(std::vector<Vec3> control) : control_(std::move(control)) {
    arcs_.push_back(0);
    const std::size_t steps = kStepsPerSpan * (control_.size() - 3);
    for (std::size_t i = 1; i <= steps; ++i)
      arcs_.push_back(arcs_.back() + length(position(parameter(i)) - position(parameter(i - 1))));
  }

  double total() const { return arcs_.back(); }

  struct Point {
    Vec3 position, tangent;
  };
  Point at(double arc) const {
    const auto above = std::upper_bound(arcs_.begin() + 1, arcs_.end() - 1, arc);
    const auto i = static_cast<std::size_t>(above - arcs_.begin());
    const double within = (arc - arcs_[i - 1]) / (arcs_[i] - arcs_[i - 1]);
    const double t = lerp(std::clamp(within, 0.0, 1.0), parameter(i - 1), parameter(i));
    return {position(t), normalize(derivative(t))};
  }

 private:
  static constexpr std::size_t kStepsPerSpan = 64;
  static double parameter(std::size_t step) { return static_cast<double>(step) / kStepsPerSpan; }

  std::size_t span(double t) const { return std::min(static_cast<std::size_t>(t), control_.size() - 4); }
  Vec3 position(double t) const {
    const std::size_t i = span(t);
    const double x = t - static_cast<double>(i), y = 1 - x;
    return (y * y * y / 6) * control_[i] + ((3 * x * x * x - 6 * x * x + 4) / 6) * control_[i + 1] +
           ((3 * y * y * y - 6 * y * y + 4) / 6) * control_[i + 2] + (x * x * x / 6) * control_[i + 3];
  }
  Vec3 derivative(double t) const {
    const std::size_t i = span(t);
    const double x = t - static_cast<double>(i), y = 1 - x;
    return (y * y) * (control_[i + 1] - control_[i]) + (1 + 2 * x * y) * (control_[i + 2] - control_[i + 1]) +
           (x * x) * (control_[i + 3] - control_[i + 2]);
  }

  std::vector<Vec3> control_;
  std::vector<double> arcs_;
};

// The coil winds inwards and rises a little, so that each turn leans on the one outside; the neck leaves it
// in the middle, goes up and comes forward over the coil.
Spline centerline(double turns) {
  constexpr int kPerTurn = 16;
  constexpr double kInnerRadius = 2.3, kRadiusStep = 1.95, kRise = 0.62, kWidening = 1.1;
  constexpr double kEndTurn = 0.17;  // the coil ends behind the middle, heading left
  std::vector<Vec3> control;
  const int count = static_cast<int>(std::lround(turns * kPerTurn));
  for (int i = -count; i <= 0; ++i) {
    const double before_end = static_cast<double>(-i) / kPerTurn;
    const double angle = 2 * kPi * (kEndTurn - before_end);
    const double radius = kInnerRadius + kRadiusStep * before_end;
    const double height = 1 + kRise * std::max(0.0, turns - before_end - 0.9);
    control.push_back({kWidening * radius * std::cos(angle), radius * std::sin(angle), height});
  }
  const double top = control.back().z;
  for (const Vec3& above : {Vec3{-0.35, 2.45, 0.45}, Vec3{-1.45, 1.9, 1.2}, Vec3{-1.9, 0.95, 2.1},
                            Vec3{-1.6, 0.15, 2.95}, Vec3{-0.95, -0.45, 3.5}, Vec3{-0.3, -1.2, 3.7},
                            Vec3{0.15, -2.2, 3.6}, Vec3{0.45, -3.2, 3.4}, Vec3{0.7, -4.2, 3.2}})
    control.push_back(above + Vec3{0, 0, top});
  return Spline(control);
}

// --- the thickness: half-axes of the cross-section ---

// A smooth curve through values at evenly spaced places in [0, 1] (Catmull-Rom).
double curve(std::span<const double> values, double x) {
  const auto last = static_cast<int>(values.size()) - 1;
  const double place = std::clamp(x, 0.0, 1.0) * last;
  const int i = std::min(static_cast<int>(place), last - 1);
  const auto value = [&](int k) { return values[static_cast<std::size_t>(std::clamp(k, 0, last))]; };
  const double t = place - i, a = value(i - 1), b = value(i), c = value(i + 1), d = value(i + 2);
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

struct CrossSection {
  double half_width, above, below;  // of the centreline

  double girth() const {  // of the two half ellipses (Ramanujan 1914)
    const auto half = [](double a, double b) {
      return kPi / 2 * (3 * (a + b) - std::sqrt((3 * a + b) * (a + 3 * b)));
    };
    return half(half_width, above) + half(half_width, below);
  }
};

constexpr double kNeckWidth = 0.58;
constexpr double kSnoutFrom = 0.8;  // of the head; from here the snout closes like an ellipse

// Of the body, but for the rounding of the tail's tip.
double body_thickness(double arc, double total) {
  const double tail = std::min(1.0, arc / (kTailFraction * total));
  const double neck = std::clamp((total - arc - kHeadLength) / kNeckLength, 0.0, 1.0);
  const double slim = lerp(neck * neck * (3 - 2 * neck), kNeckWidth, 1);
  return slim * (0.05 + 0.95 * std::pow(std::sin(kPi / 2 * tail), 0.8));
}

CrossSection body_section(double arc, double total) {
  const double radius = std::sqrt(std::min(1.0, arc / kTipLength)) * body_thickness(arc, total);
  return {radius, radius, radius};
}

CrossSection head_section(double along) {
  constexpr double kWidth[] = {kNeckWidth, 0.60, 0.68, 0.79, 0.84, 0.81, 0.71, 0.58, 0.48};
  constexpr double kAbove[] = {kNeckWidth, 0.56, 0.54, 0.54, 0.53, 0.48, 0.40, 0.32, 0.26};
  constexpr double kBelow[] = {kNeckWidth, 0.52, 0.47, 0.43, 0.40, 0.36, 0.31, 0.27, 0.24};
  const double into_snout = std::clamp((along - kSnoutFrom) / (1 - kSnoutFrom), 0.0, 1.0);
  const double close = std::sqrt(1 - square(into_snout));
  return {close * curve(kWidth, along), close * curve(kAbove, along), close * curve(kBelow, along)};
}

CrossSection section_at(double arc, double total) {
  const double along = (arc - (total - kHeadLength)) / kHeadLength;
  return along < 0 ? body_section(arc, total) : head_section(std::min(along, 1.0));
}

// On the centreline, lowered where the tail is thin, so that it rests on the ground.
Spline::Point center_at(const Spline& spline, double arc) {
  Spline::Point point = spline.at(arc);
  if (arc < kTailFraction * spline.total()) point.position.z -= 1 - body_thickness(arc, spline.total());
  return point;
}

// --- the features of the head: a factor on the cross-section ---

// Places on the head: how far along it, and u of the right half.
struct HeadPlace {
  double along, u;
};
constexpr HeadPlace kEye{0.69, 0.36}, kNostril{0.94, 0.34};

// The way from `from` over the skin, about: along the head and upwards.
Point2 head_offset(const HeadPlace& from, double along, double u) {
  constexpr double kGirth = 4;
  return {(along - from.along) * kHeadLength, (std::min(u, 1 - u) - from.u) * kGirth};
}

double bump(double distance, double width) { return std::exp(-square(distance / width)); }

// A groove along both sides.
double mouth(double along, double u) {
  if (along < 0.35) return 0;
  const double reach = std::min(1.0, (along - 0.35) / 0.15);
  return -0.1 * reach * bump(std::min(u, 1 - u) - 0.2, 0.014);
}

// The skin swells about the eye and folds into a rim that is strongest above it, the brow.
constexpr double kEyeRadius = 0.16, kEyeProtrusion = 0.017;
double orbit(double along, double u) {
  const Point2 offset = head_offset(kEye, along, u);
  const double distance = std::hypot(offset.x, offset.y);
  const double opening = std::sqrt(square(kEyeRadius) - square(kEyeRadius - kEyeProtrusion));
  const double above = distance > 0 ? offset.y / distance : 0;
  return 0.03 * bump(distance, 0.35) + (0.035 + 0.02 * above) * bump(distance - opening - 0.04, 0.045);
}

double nostril(double along, double u) {
  const Point2 offset = head_offset(kNostril, along, u);
  return -0.12 * bump(std::hypot(offset.x, offset.y), 0.04);
}

double features(double along, double u) {
  return along < 0 ? 1 : 1 + mouth(along, u) + orbit(along, u) + nostril(along, u);
}

// --- frames ---

struct Ring {
  double arc = 0, v = 0;
  Vec3 center = {}, tangent = {}, up = {}, right = {};
  CrossSection section = {};
};

// `up` turned as little as possible from one tangent to the next (parallel transport), so that nothing
// twists, and then a little towards the vertical, so that the belly stays down; the less the steeper the
// body.
Vec3 next_up(const Vec3& up, const Vec3& tangent, double step) {
  constexpr double kRighting = 0.5;  // per body radius
  const Vec3 carried = up - dot(up, tangent) * tangent;
  const Vec3 vertical = Vec3{0, 0, 1} - tangent.z * tangent;
  return normalize(carried + std::min(1.0, kRighting * step) * vertical);
}

// Where rings stand: a fixed part of the girth apart, closer at both ends, which are round.
std::vector<double> ring_arcs(double total, int per_girth) {
  constexpr int kEndRings = 12;
  const double snout = total - (1 - kSnoutFrom) * kHeadLength;
  std::vector<double> arcs;
  for (int i = 0; i < kEndRings; ++i) arcs.push_back(kTipLength * square(static_cast<double>(i) / kEndRings));
  for (double arc = kTipLength; arc < snout;) {
    arcs.push_back(arc);
    const double step = std::max(section_at(arc, total).girth(), 0.5) / per_girth;
    arc += arc < total - kHeadLength ? step : 0.5 * step;  // the head has finer features
  }
  const double first = arcs.back();
  for (int i = 1; i <= 2 * kEndRings; ++i)
    arcs.push_back(lerp(std::sin(kPi / 2 * i / (2 * kEndRings)), first, total));
  return arcs;
}

std::vector<Ring> make_rings(const Spline& spline, int per_girth) {
  // v would grow without bounds towards the ends; on the head it is to stay below 1.
  constexpr double kLeastGirth = 0.8, kLeastHeadGirth = 3.2;
  std::vector<Ring> rings;
  for (const double arc : ring_arcs(spline.total(), per_girth)) {
    const auto [center, tangent] = center_at(spline, arc);
    Ring ring{.arc = arc, .center = center, .tangent = tangent, .section = section_at(arc, spline.total())};
    if (rings.empty()) {
      ring.up = normalize(Vec3{0, 0, 1} - tangent.z * tangent);
    } else {
      const Ring& last = rings.back();
      const double girth = 0.5 * (ring.section.girth() + last.section.girth());
      const double least = arc < spline.total() - kHeadLength ? kLeastGirth : kLeastHeadGirth;
      ring.v = last.v + (arc - last.arc) / std::max(girth, least);
      ring.up = next_up(last.up, tangent, arc - last.arc);
    }
    ring.right = cross(ring.up, tangent);
    rings.push_back(ring);
  }
  const auto nape = std::find_if(rings.begin(), rings.end(),
                                 [&](const Ring& r) { return r.arc >= spline.total() - kHeadLength; });
  const double nape_v = nape->v - (nape->arc - (spline.total() - kHeadLength)) / nape->section.girth();
  for (Ring& ring : rings) ring.v -= nape_v;
  return rings;
}

Vec3 surface_point(const Ring& ring, double u, double head_along) {
  const double angle = 2 * kPi * u, c = -std::cos(angle), s = std::sin(angle);
  const double height = c > 0 ? ring.section.above : ring.section.below;
  return ring.center +
         features(head_along, u) * (height * c * ring.up + ring.section.half_width * s * ring.right);
}

// --- the mesh ---

// Vertices ring by ring, `around` + 1 to a ring.
void add_skin(Mesh& mesh, const std::vector<Ring>& rings, int around, double total) {
  for (const Ring& ring : rings) {
    const double head_along = (ring.arc - (total - kHeadLength)) / kHeadLength;
    const bool is_end = &ring == &rings.front() || &ring == &rings.back();
    for (int j = 0; j <= around; ++j) {
      const double u = static_cast<double>(j % around) / around;
      mesh.positions.push_back(is_end ? ring.center : surface_point(ring, u, head_along));
      mesh.uvs.push_back({static_cast<double>(j) / around, ring.v});
    }
  }
  const auto columns = static_cast<std::uint32_t>(rings.size()) - 1, n = static_cast<std::uint32_t>(around);
  const auto position = [&](std::uint32_t i, std::uint32_t j) { return mesh.positions[i * (n + 1) + j % n]; };
  for (std::uint32_t i = 0; i <= columns; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) {
      if (i == 0 || i == columns) {
        mesh.normals.push_back(i == 0 ? -rings[i].tangent : rings[i].tangent);
        continue;
      }
      const Vec3 along_u = position(i, j % n + 1) - position(i, j % n + n - 1);
      const Vec3 along_v = position(i + 1, j) - position(i - 1, j);
      mesh.normals.push_back(normalize(cross(along_u, along_v)));
    }
}

void append(Mesh& mesh, const Mesh& part) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

Mesh eyes_mesh(const std::vector<Ring>& rings, double total) {
  const double arc = total - (1 - kEye.along) * kHeadLength;
  const auto ring = std::find_if(rings.begin(), rings.end(), [&](const Ring& r) { return r.arc >= arc; });
  Mesh eyes;
  for (const double u : {kEye.u, 1 - kEye.u}) {
    Mesh eye = sphere_mesh(kEyeRadius, 48);
    const Vec3 on_skin = surface_point(*ring, u, kEye.along);
    const Vec3 outwards = normalize(on_skin - ring->center);
    eye = transformed(std::move(eye), {.translate = on_skin - (kEyeRadius - kEyeProtrusion) * outwards});
    for (Point2& uv : eye.uvs) uv = {u, ring->v};
    append(eyes, eye);
  }
  return eyes;
}

}  // namespace

Snake make_snake(const SnakeShape& shape) {
  const Spline spline = centerline(shape.turns);
  const std::vector<Ring> rings = make_rings(spline, shape.resolution / 2);
  Mesh skin;
  add_skin(skin, rings, shape.resolution, spline.total());
  connect_grid(skin, static_cast<std::uint32_t>(rings.size()) - 1,
               static_cast<std::uint32_t>(shape.resolution));
  for (auto& triangle : skin.triangles) std::swap(triangle[1], triangle[2]);  // u runs along rings here
  const Transform size{.scale = shape.body_radius};
  return {transformed(std::move(skin), size), transformed(eyes_mesh(rings, spline.total()), size)};
}

Mesh snake_mesh(const SnakeShape& shape) {
  Snake snake = make_snake(shape);
  append(snake.skin, snake.eyes);
  return std::move(snake.skin);
}

std::vector<SnakePoint> snake_centerline(const SnakeShape& shape, int points) {
  const Spline spline = centerline(shape.turns);
  std::vector<SnakePoint> result;
  for (int i = 0; i < points; ++i) {
    const double arc = spline.total() * i / (points - 1);
    result.push_back({center_at(spline, arc).position, arc, section_at(arc, spline.total()).half_width});
  }
  return result;
}

}  // namespace sunbeam
