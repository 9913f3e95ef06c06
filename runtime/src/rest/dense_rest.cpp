#include "runtime/src/rest/dense_rest.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::size_t kCurveNodes = 1025;  // linear between: towards grazing T is curved

// Shares of the nodes in the mean over the axis: two Gauss points an interval are exact for cubics.
std::vector<double> mean_weights(const Axis& axis) {
  const std::size_t n = axis.size();
  if (n == 1) return {1};
  const double gauss = 0.5 / std::sqrt(3.0);
  std::vector<double> weights(n);
  for (std::size_t k = 0; k + 1 < n; ++k)
    for (const double t : {0.5 - gauss, 0.5 + gauss}) {
      const Stencil at = axis.stencil(lerp(t, axis.nodes[k], axis.nodes[k + 1]));
      const double share = (axis.nodes[k + 1] - axis.nodes[k]) / (2 * (axis.nodes.back() - axis.nodes[0]));
      for (std::size_t j = 0; j < at.count; ++j) weights[at.node[j]] += share * at.weight[j];
    }
  return weights;
}

std::vector<Color4> nodes_of(const NdArray& array) {
  std::vector<Color4> nodes;
  nodes.reserve(array.cells());
  for (std::size_t k = 0; k < array.cells(); ++k) nodes.push_back(to_color4(array.get(k)));
  return nodes;
}

ThreeAxes first_axes(const NdArray& array) {
  ThreeAxes axes;
  for (std::size_t k = 0; k < 3; ++k) axes[k] = BoundAxis(array.axes()[k], array.stride(k));
  return axes;
}

// Sum of what `of_node` finds at nodes of three axes.
template <class OfNode>
Color4 sum_over(const ThreeAxes& axes, const std::array<double, 3>& x, OfNode of_node) {
  const auto a = axes[0].at(x[0]), b = axes[1].at(x[1]), c = axes[2].at(x[2]);
  Color4 sum{};
  for (int i = 0; i < a.count; ++i)
    for (int j = 0; j < b.count; ++j)
      for (int k = 0; k < c.count; ++k)
        sum += a.weight[i] * b.weight[j] * c.weight[k] * of_node(a.offset[i] + b.offset[j] + c.offset[k]);
  return sum;
}

}  // namespace

DenseFilm::DenseFilm(const NdArray& array) : axes_(first_axes(array)), nodes_(nodes_of(array)) {}

Rgb DenseFilm::at(const Parameters& at, double cosine) const {
  return to_rgb(sum_over(axes_, {at.film_thickness_nm, at.base_ior, cosine},
                         [&](int offset) -> const Color4& { return nodes_[offset]; }));
}

DenseRest::DenseRest(const Table& table)
    : material_(table.material),
      symmetry_(table.symmetry),
      is_full_(table.is_full_spectrum()),
      angles_(std::in_place, table.remainder, table.symmetry),
      remainder_(nodes_of(table.remainder)),
      axes_(first_axes(table.remainder)),
      reflectance_(table.film_reflectance) {
  if (table.frame == FrameKind::closed)
    frame_.emplace(material_, table.first_visit, table.has_layered_film());
  if (!table.film_transmittance.empty()) transmittance_.emplace(table.film_transmittance);
}

DenseRest::DenseRest(const Table& table, const Material& material)
    : material_(material), symmetry_(table.symmetry), is_full_(table.is_full_spectrum()) {
  const auto point = Parameters::of(material).values();
  const NdArray sliced = table.remainder.slice(point);
  stderr_ = table.rest_stderr.slice(point);
  angles_.emplace(sliced, symmetry_);
  remainder_ = nodes_of(sliced);
  if (table.frame == FrameKind::none) return;
  frame_.emplace(material, table.first_visit, table.has_layered_film());
  const bool reflects = table.film_transmittance.empty();
  const NdArray film =
      (reflects ? table.film_reflectance : table.film_transmittance).slice(std::span(point).first(2));
  for (std::size_t i = 0; i < kCurveNodes; ++i) {
    const Rgb value = film.interpolate(std::array{static_cast<double>(i) / (kCurveNodes - 1)});
    transmittances_.push_back(reflects ? Rgb(1) - value : value);
  }
}

Rgb DenseRest::transmittance(const Parameters& at, double cosine) const {
  return transmittance_ ? transmittance_->at(at, cosine) : Rgb(1) - reflectance_->at(at, cosine);
}

inline Rgb DenseRest::transmittance(double cosine) const {
  const Bracket at = even_bracket(cosine, kCurveNodes);
  return (1 - at.upper_weight) * transmittances_[at.lower] + at.upper_weight * transmittances_[at.upper];
}

Rgb DenseRest::remainder(const Parameters& at, const AngleCoordinates& angles) const {
  const DenseAngles::Place place(*angles_, angles);
  if (!axes_) return to_rgb(place.sum(remainder_.data()));
  return to_rgb(
      sum_over(*axes_, at.values(), [&](int offset) { return place.sum(remainder_.data() + offset); }));
}

Rgb DenseRest::decoded(const Parameters& at, const Rgb& remainder, double cos_i, double cos_o) const {
  if (frame_ && !axes_)
    return frame_->decode(remainder, cos_i, cos_o, transmittance(cos_i), transmittance(cos_o));
  if (frame_)
    return frame_->over(at.applied_to(material_))
        .decode(remainder, cos_i, cos_o, transmittance(at, cos_i), transmittance(at, cos_o));
  if (is_full_) return remainder;
  return transform(remainder, [](double x) { return std::max(0.0, x); });
}

Rgb DenseRest::rest(const Parameters& at, const Vec3& wo, const Vec3& wi) const {
  return decoded(at, remainder(at, angles_->coordinates(wo, wi)), wi.z, wo.z);
}

Rgb DenseRest::standard_error(const Vec3& wo, const Vec3& wi) const {
  const AngleCoordinates c = angles_->coordinates(wo, wi);
  const Rgb error = stderr_.interpolate(std::array{c.cos_i, c.phi_i, c.cos_o, c.phi_o});
  return transform(error, [](double x) { return std::max(0.0, x); });
}

std::size_t DenseRest::bytes() const {
  return remainder_.size() * sizeof(Color4) + (reflectance_ ? reflectance_->bytes() : 0) +
         (transmittance_ ? transmittance_->bytes() : 0) + transmittances_.size() * sizeof(Rgb);
}

// Azimuths of an isotropic table are those of wi from wo; those of an anisotropic one are of a quadrant, and
// wo mirrored stands for wi in the other three.
DenseRest::AzimuthMean::AzimuthMean(const DenseRest& rest, const Parameters& at, const Vec3& wo)
    : rest_(rest), at_(at), cos_o_(wo.z) {
  const bool isotropic = rest.symmetry_ == Symmetry::isotropic;
  const Axis& axis = rest.angles_->axis(isotropic ? 3 : 1);
  const auto weights = mean_weights(axis);
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
    remainder += node.weight * rest_.remainder(at_, {cos_i, node.phi_i, cos_o_, node.phi_o});
  return rest_.decoded(at_, remainder, cos_i, cos_o_);
}

}  // namespace v1
}  // namespace sunbeam
