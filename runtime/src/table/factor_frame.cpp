#include "sunbeam/detail/factor_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sunbeam/detail/factors.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastShare = 1e-30;  // its logarithm is taken
constexpr double kMostLogShare = 2;    // at 0 all light arrives, and interpolation errs by little
constexpr double kFloor = 1e-4;        // where the film reflects all but this, the rest does not tell

bool bends(const Material& m) { return m.transmission == Transmission::refract; }

}  // namespace

double critical_cosine(const Material& material) {
  return std::sqrt(std::max(0.0, 1 - square(material.base_ior / material.exterior_ior)));
}

double entering_cosine(const Material& material, double cosine, double least_below) {
  if (!material.is_smooth() || material.base_ior >= material.exterior_ior) return cosine;
  constexpr double kJustInside = 1e-4;
  const double critical = critical_cosine(material);
  if (!bends(material)) return std::max(cosine, critical + kJustInside);
  // The pigment must let pass what is divided by: exp(-30) of it.
  const double below = std::max(least_below, material.optical_depth() / 30);
  const double inside =
      std::hypot(critical, std::min(below, 1.0) * material.base_ior / material.exterior_ior);
  return std::max(cosine, std::min(inside, 1.0));
}

Axis critical_axis(const Material& material) {
  Axis axis{"", "1", {}, 2, 0, critical_cosine(material)};
  axis.softness = std::sqrt(material.roughness.u * material.roughness.v);
  return axis;
}

FactorFrame::FactorFrame(const Material& material, bool reaches_below)
    : material_(material),
      is_warped_(reaches_below && !material.is_smooth()),
      floor_(is_warped_ ? kFloor : 0),
      critical_(critical_axis(material)),
      first_(critical_.coordinate(kLowestArrayCosine)),
      extent_(critical_.coordinate(1) - first_) {}

double FactorFrame::coordinate(double cosine) const {
  return is_warped_ ? (critical_.coordinate(cosine) - first_) / extent_ : cosine;
}

double FactorFrame::cosine(double coordinate) const {
  if (!is_warped_) return coordinate;
  return std::clamp(critical_.at_coordinate(first_ + coordinate * extent_), kLowestArrayCosine, 1.0);
}

double FactorFrame::slope(double coordinate) const {
  const double u = first_ + coordinate * extent_, root = std::sqrt(u * u + 4 * critical_.softness);
  return extent_ * (std::abs(u) + (root + u * u / root) / 2);
}

double FactorFrame::pigment_cosine(double cosine) const {
  if (is_warped_ && bends(material_)) return std::numeric_limits<double>::infinity();
  return arrival_cosine(material_, cosine);
}

double FactorFrame::one_visit_cosine(double cosine) const {
  const double below = material_.cosine_below(cosine);
  return is_warped_ && bends(material_) ? std::hypot(below, critical_.softness / 2) : below;
}

double FactorFrame::arrival(double share, double decay) const {
  return std::log(std::max(share + floor_, kLeastShare)) + decay;
}

double FactorFrame::share(double arrival, double decay) const {
  if (!is_warped_) return std::exp(std::min(arrival - decay, kMostLogShare));
  return std::max(0.0, std::exp(std::min(arrival, kMostLogShare)) - floor_) * std::exp(-decay);
}

}  // namespace v1
}  // namespace sunbeam
