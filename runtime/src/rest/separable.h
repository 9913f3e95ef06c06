// This file looks up the rest of a factored table at one parameter point, for directions w = (c, phi), c the
// cosine:
//
//   rest(wi, wo) = S(wi) S(wo) Q(wi, wo)     1/sr, each colour channel apart
//
// S is the share of a direction's light that reaches the base, folded into colours. It holds the fringes and
// the pigment's decay and lies on a fine grid, even in c. Q is what is left: the gain of the base, its
// visits, and what is lost by folding both directions apart. It is smooth and lies on a coarse grid, even in
// the root of c. An anisotropic film has azimuths too, folded into the first quadrant; its grids are even in
// them. All is linear between nodes.
//
// bake/factored/arrival.h and its neighbours make the factors, sunbeam/detail/factors.h stores them, and
// runtime/src/fit/bound_fit.h makes S and Q of them.
#pragma once

#include <vector>

#include "runtime/src/base/color4.h"

namespace sunbeam {
inline namespace v1 {

// Evaluates the equation above, of two values of S and one of Q.
inline Color4 separable_rest(const Color4& scale_o, const Color4& scale_i, const Color4& ratio) {
  return scale_o * scale_i * ratio;
}

// Holds S and Q of an isotropic film. A place beyond the last node, of weight 0, may be read. The last lanes
// are the owner's: BoundTable keeps there what its sampling looks up at the same places.
struct Separable {
  static constexpr int kScaleCosines = 513, kRatioRoots = 33, kMostClearRoots = 65, kMostRatioRoots = 257;

  explicit Separable(int roots = kRatioRoots)
      : ratio_roots(roots), ratios(static_cast<std::size_t>((roots + 1) * roots + 1)) {}

  Color4 scale(const EvenPosition& cosine) const { return lerp(scales.data(), cosine); }
  Color4 ratio(const EvenPosition& root_o, const EvenPosition& root_i) const {
    const Color4* row = ratios.data() + root_o.lower * ratio_roots;
    const Color4 low = lerp(row, root_i), high = lerp(row + ratio_roots, root_i);
    return low + root_o.upper_weight * (high - low);
  }
  // Returns the rest, 1/sr, of two cosines in (0, 1].
  Color4 rest(float cos_o, float cos_i) const;

  int ratio_roots;                                                      // kRatioRoots doubled so often
  std::vector<Color4> scales = std::vector<Color4>(kScaleCosines + 1);  // S
  std::vector<Color4> ratios;                                           // Q at (wo, wi)
};

// Holds S and Q of an anisotropic film, at (c, phi) and (wo, wi).
struct AnisotropicSeparable {
  static constexpr int kScaleCosines = 129, kScaleAzimuths = 17;
  static constexpr int kRatioRoots = 25, kRatioAzimuths = 7;
  static constexpr int kRatioNodes = kRatioRoots * kRatioAzimuths;

  // Returns the rest, 1/sr, for directions above the horizon.
  Color4 rest(const Vec3& wo, const Vec3& wi) const;

  std::vector<Color4> scales, ratios;

 private:
  Color4 scale(float cosine, float phi) const;
};

}  // namespace v1
}  // namespace sunbeam
