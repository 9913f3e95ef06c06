#include "runtime/src/fit/dense_albedos.h"

#include "runtime/src/rest/dense_rest.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kNodes = 4;  // of each parameter
constexpr int kRoots = 9;  // even roots of the cosine
constexpr int kLightCosines = 16, kViewerAzimuths = 4;
constexpr double kLeastCosine = 1e-4;

// Int rest cos dwi by midpoints in the cosine, mean over channels and the viewer's azimuth.
double albedo_of(const DenseRest& rest, const Parameters& at, double cosine, Symmetry symmetry) {
  const int azimuths = symmetry == Symmetry::isotropic ? 1 : kViewerAzimuths;
  double sum = 0;
  for (int a = 0; a < azimuths; ++a) {
    const double phi = azimuths == 1 ? 0 : kPi / 2 * (a + 0.5) / azimuths;
    const DenseRest::AzimuthMean mean_rest(rest, at, direction_from_cosine(cosine, phi));
    for (int k = 0; k < kLightCosines; ++k) {
      const double cos_i = (k + 0.5) / kLightCosines;
      sum += mean(mean_rest(cos_i)) * cos_i;
    }
  }
  return std::max(0.0, sum * 2 * kPi / (kLightCosines * azimuths));
}

}  // namespace

DenseAlbedos::DenseAlbedos(const Table& table)
    : axes_{EvenAxis(table.parameter_axis(0), kNodes), EvenAxis(table.parameter_axis(1), kNodes),
            EvenAxis(table.parameter_axis(2), kNodes)} {
  for (int d = 0; d < kNodes; ++d)
    for (int n = 0; n < kNodes; ++n)
      for (int s = 0; s < kNodes; ++s) {
        const Parameters at{axes_[0].node(d), axes_[1].node(n), axes_[2].node(s)};
        const DenseRest rest(table, at.applied_to(table.material));
        for (int c = 0; c < kRoots; ++c) {
          const double root = static_cast<double>(c) / (kRoots - 1);
          nodes_.push_back(
              static_cast<float>(albedo_of(rest, at, std::max(root * root, kLeastCosine), table.symmetry)));
        }
      }
}

float DenseAlbedos::at(const Parameters& at, float root) const {
  const EvenPosition cosine(root, kRoots), d = axes_[0].locate(at.film_thickness_nm),
                                           n = axes_[1].locate(at.base_ior),
                                           s = axes_[2].locate(at.absorption_per_nm);
  const auto along_absorption = [&](int row) {
    const float* first = nodes_.data() + (row * kNodes + s.lower) * kRoots;
    const float low = lerp(first, cosine), high = lerp(first + kRoots, cosine);
    return low + s.upper_weight * (high - low);
  };
  const auto along_ior = [&](int row) {
    const float low = along_absorption(row * kNodes + n.lower),
                high = along_absorption(row * kNodes + n.lower + 1);
    return low + n.upper_weight * (high - low);
  };
  const float low = along_ior(d.lower), high = along_ior(d.lower + 1);
  return low + d.upper_weight * (high - low);
}

}  // namespace v1
}  // namespace sunbeam
