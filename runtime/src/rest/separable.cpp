#include "runtime/src/rest/separable.h"

#include "runtime/src/base/compiler.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// The azimuth folded into [0, pi/2], over pi/2.
float quadrant(const Vec3& w) {
  return static_cast<float>(std::atan2(std::abs(w.y), std::abs(w.x)) * (2 / kPi));
}

float weight(const EvenPosition& at, int upper) { return upper ? at.upper_weight : 1 - at.upper_weight; }

}  // namespace

Color4 Separable::rest(float cos_o, float cos_i) const {
  const EvenPosition root_o(std::sqrt(cos_o), ratio_roots), root_i(std::sqrt(cos_i), ratio_roots);
  return separable_rest(scale(EvenPosition(cos_o, kScaleCosines)), scale(EvenPosition(cos_i, kScaleCosines)),
                        ratio(root_o, root_i));
}

Color4 AnisotropicSeparable::scale(float cosine, float phi) const {
  const EvenPosition c(cosine, kScaleCosines), p(phi, kScaleAzimuths);
  const Color4* row = scales.data() + c.lower * kScaleAzimuths;
  const Color4 low = lerp(row, p), high = lerp(row + kScaleAzimuths, p);
  return low + c.upper_weight * (high - low);
}

Color4 AnisotropicSeparable::rest(const Vec3& wo, const Vec3& wi) const {
  const float cos_o = static_cast<float>(wo.z), cos_i = static_cast<float>(wi.z);
  const float phi_o = quadrant(wo), phi_i = quadrant(wi);
  const EvenPosition o(std::sqrt(cos_o), kRatioRoots), by_o(phi_o, kRatioAzimuths);
  const EvenPosition i(std::sqrt(cos_i), kRatioRoots), by_i(phi_i, kRatioAzimuths);
  Color4 ratio{};
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      const int node = (o.lower + a) * kRatioAzimuths + by_o.lower + b;
      const Color4* row = ratios.data() + node * kRatioNodes + i.lower * kRatioAzimuths;
      const Color4 low = lerp(row, by_i), high = lerp(row + kRatioAzimuths, by_i);
      ratio += weight(o, a) * weight(by_o, b) * (low + i.upper_weight * (high - low));
    }
  return separable_rest(scale(cos_o, phi_o), scale(cos_i, phi_i), ratio);
}

}  // namespace v1
}  // namespace sunbeam
