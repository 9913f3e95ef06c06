#include "runtime/src/lookup/textured_dense.h"

#include "runtime/src/lookup/dense_rest.h"

namespace sunbeam::inline v1 {
namespace {

constexpr int kAlbedoNodes = 4;  // of each parameter
constexpr int kLightCosines = 16, kViewerAzimuths = 4;
constexpr double kLeastCosine = 1e-4;

std::vector<Color4> to_color4(const NdArray& array) {
  std::vector<Color4> nodes;
  nodes.reserve(array.cells());
  for (std::size_t k = 0; k < array.cells(); ++k) nodes.push_back(to_color4(array.get(k)));
  return nodes;
}

template <std::size_t kCount>
std::array<BoundAxis, kCount> first_axes(const NdArray& array) {
  std::array<BoundAxis, kCount> axes;
  for (std::size_t k = 0; k < kCount; ++k) axes[k] = BoundAxis(array.axes()[k], array.stride(k));
  return axes;
}

// Sum of what `of_node` finds at nodes of three axes.
template <class OfNode>
Color4 sum_over(const std::array<BoundAxis, 3>& axes, const std::array<double, 3>& x, OfNode of_node) {
  const auto a = axes[0].at(x[0]), b = axes[1].at(x[1]), c = axes[2].at(x[2]);
  Color4 sum{};
  for (int i = 0; i < a.count; ++i)
    for (int j = 0; j < b.count; ++j)
      for (int k = 0; k < c.count; ++k)
        sum += a.weight[i] * b.weight[j] * c.weight[k] * of_node(a.offset[i] + b.offset[j] + c.offset[k]);
  return sum;
}

// Int rest cos dwi by midpoints in the cosine, mean over channels and the viewer's azimuth.
double albedo_of(const DenseRest& rest, double cosine, Symmetry symmetry) {
  const int azimuths = symmetry == Symmetry::isotropic ? 1 : kViewerAzimuths;
  double sum = 0;
  for (int a = 0; a < azimuths; ++a) {
    const double phi = azimuths == 1 ? 0 : kPi / 2 * (a + 0.5) / azimuths;
    const DenseRest::AzimuthMean mean_rest(rest, direction_from_cosine(cosine, phi));
    for (int k = 0; k < kLightCosines; ++k) {
      const double cos_i = (k + 0.5) / kLightCosines;
      sum += mean(mean_rest(cos_i)) * cos_i;
    }
  }
  return std::max(0.0, sum * 2 * kPi / (kLightCosines * azimuths));
}

}  // namespace

TexturedDense::Film::Film(const NdArray& array) : axes_(first_axes<3>(array)), nodes_(to_color4(array)) {}

Rgb TexturedDense::Film::at(const Parameters& at, double cosine) const {
  return to_rgb(sum_over(axes_, {at.film_thickness_nm, at.base_ior, cosine},
                         [&](int offset) -> const Color4& { return nodes_[offset]; }));
}

TexturedDense::TexturedDense(const Table& table)
    : material_(table.material),
      is_full_(table.is_full_spectrum()),
      reflectance_(table.film_reflectance),
      axes_(first_axes<3>(table.remainder)),
      angles_(table.remainder, table.symmetry),
      remainder_(to_color4(table.remainder)),
      albedo_axes_{EvenAxis(table.parameter_axis(0), kAlbedoNodes),
                   EvenAxis(table.parameter_axis(1), kAlbedoNodes),
                   EvenAxis(table.parameter_axis(2), kAlbedoNodes)} {
  if (table.frame == FrameKind::closed) frame_.emplace(material_, table.first_visit);
  if (!table.film_transmittance.empty()) transmittance_.emplace(table.film_transmittance);
  find_albedos(table);
}

void TexturedDense::find_albedos(const Table& table) {
  for (int d = 0; d < kAlbedoNodes; ++d)
    for (int n = 0; n < kAlbedoNodes; ++n)
      for (int s = 0; s < kAlbedoNodes; ++s) {
        const Parameters at{albedo_axes_[0].node(d), albedo_axes_[1].node(n), albedo_axes_[2].node(s)};
        const DenseRest rest(table, at.applied_to(material_));
        for (int c = 0; c < kAlbedoRoots; ++c) {
          const double root = static_cast<double>(c) / (kAlbedoRoots - 1);
          albedos_.push_back(
              static_cast<float>(albedo_of(rest, std::max(root * root, kLeastCosine), table.symmetry)));
        }
      }
}

float TexturedDense::rest_albedo(const Parameters& at, float root) const {
  const EvenPosition cosine(root, kAlbedoRoots), d = albedo_axes_[0].locate(at.film_thickness_nm),
                                                 n = albedo_axes_[1].locate(at.base_ior),
                                                 s = albedo_axes_[2].locate(at.absorption_per_nm);
  const auto along_absorption = [&](int row) {
    const float* first = albedos_.data() + (row * kAlbedoNodes + s.lower) * kAlbedoRoots;
    const float low = lerp(first, cosine), high = lerp(first + kAlbedoRoots, cosine);
    return low + s.upper_weight * (high - low);
  };
  const auto along_ior = [&](int row) {
    const float low = along_absorption(row * kAlbedoNodes + n.lower),
                high = along_absorption(row * kAlbedoNodes + n.lower + 1);
    return low + n.upper_weight * (high - low);
  };
  const float low = along_ior(d.lower), high = along_ior(d.lower + 1);
  return low + d.upper_weight * (high - low);
}

Rgb TexturedDense::film_reflectance(const Parameters& at, double cosine) const {
  return reflectance_.at(at, cosine);
}

Rgb TexturedDense::transmittance(const Parameters& at, double cosine) const {
  return transmittance_ ? transmittance_->at(at, cosine) : Rgb(1) - reflectance_.at(at, cosine);
}

Color4 TexturedDense::remainder(const Parameters& at, const AngleCoordinates& angles) const {
  const DenseAngles::Place place(angles_, angles);
  return sum_over(axes_, at.values(), [&](int offset) { return place.sum(remainder_.data() + offset); });
}

Rgb TexturedDense::rest(const Parameters& at, const Vec3& wo, const Vec3& wi) const {
  const Rgb remainder = to_rgb(this->remainder(at, angles_.coordinates(wo, wi)));
  if (frame_)
    return frame_->over(at.applied_to(material_))
        .decode(remainder, wi.z, wo.z, transmittance(at, wi.z), transmittance(at, wo.z));
  if (is_full_) return remainder;
  return transform(remainder, [](double x) { return std::max(0.0, x); });
}

std::size_t TexturedDense::bytes() const {
  return remainder_.size() * sizeof(Color4) + reflectance_.bytes() +
         (transmittance_ ? transmittance_->bytes() : 0) + albedos_.size() * sizeof(float);
}

}  // namespace sunbeam::inline v1
