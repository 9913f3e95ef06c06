#include "dense_rest.h"

namespace sunbeam {
namespace {

constexpr std::size_t kCurveNodes = 129;

// Shares of the interval between an axis' ends that belong to its nodes, for a function linear between them.
std::vector<double> trapezoid(const Axis& axis) {
  const std::size_t n = axis.size();
  if (n == 1) return {1};
  std::vector<double> weights(n);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const double half = (axis.nodes[k + 1] - axis.nodes[k]) / (2 * (axis.high() - axis.low()));
    weights[k] += half;
    weights[k + 1] += half;
  }
  return weights;
}

}  // namespace

DenseRest::DenseRest(const Table& table, const Material& material)
    : symmetry_(table.symmetry), frame_(material, table.first_visit) {
  const auto point = Parameters::of(material).values();
  remainder_ = table.remainder.slice(point);
  stderr_ = table.rest_stderr.slice(point);
  has_azimuth_ = remainder_.axes()[1].size() > 1 || remainder_.axes()[3].size() > 1;
  for (std::size_t i = 0; i < kCurveNodes; ++i)
    transmittance_.push_back(
        table.transmittance({point[0], point[1], static_cast<double>(i) / (kCurveNodes - 1)}));
}

Rgb DenseRest::transmittance(double cosine) const {
  const Bracket at = even_bracket(cosine, kCurveNodes);
  return (1 - at.upper_weight) * transmittance_[at.lower] + at.upper_weight * transmittance_[at.upper];
}

std::array<double, 4> DenseRest::coordinates(const Vec3& wo, const Vec3& wi) const {
  if (!has_azimuth_) return {wi.z, 0, wo.z, 0};
  const AngleCoordinates c = to_coordinates(symmetry_, {wo, wi});
  return {c.cos_i, c.phi_i, c.cos_o, c.phi_o};
}

Rgb DenseRest::operator()(const Vec3& wo, const Vec3& wi) const {
  const Rgb remainder = remainder_.interpolate(coordinates(wo, wi));
  return frame_.decode(remainder, wi.z, wo.z, transmittance(wi.z), transmittance(wo.z));
}

Rgb DenseRest::standard_error(const Vec3& wo, const Vec3& wi) const {
  return stderr_.interpolate(coordinates(wo, wi));
}

// The table is linear between azimuths, so that the trapezoids of its nodes are exact. Those of an isotropic
// table are azimuths of wi from wo; those of an anisotropic one are of a quadrant, and wo mirrored stands for
// wi in the other three.
DenseRest::AzimuthMean::AzimuthMean(const DenseRest& rest, const Vec3& wo) : rest_(rest), cos_o_(wo.z) {
  const bool isotropic = rest.symmetry_ == Symmetry::isotropic;
  const Axis& axis = rest.remainder_.axes()[isotropic ? 3 : 1];
  const auto weights = trapezoid(axis);
  for (std::size_t k = 0; k < axis.size(); ++k) {
    if (isotropic) {
      nodes_.push_back({0, axis.nodes[k], weights[k]});
      continue;
    }
    for (const double x : {wo.x, -wo.x})
      for (const double y : {wo.y, -wo.y})
        nodes_.push_back({axis.nodes[k], azimuth({x, y, wo.z}), weights[k] / 4});
  }
}

Rgb DenseRest::AzimuthMean::operator()(double cos_i) const {
  Rgb remainder;
  for (const Node& node : nodes_)
    remainder +=
        node.weight * rest_.remainder_.interpolate(std::array{cos_i, node.phi_i, cos_o_, node.phi_o});
  return rest_.frame_.decode(remainder, cos_i, cos_o_, rest_.transmittance(cos_i),
                             rest_.transmittance(cos_o_));
}

}  // namespace sunbeam
