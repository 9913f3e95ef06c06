// This file says at which cosines a textured table whose film is layered holds R and P
// (sunbeam/textured_table.h). Over a base of lower index than the exterior both have a knee at the cosine of
// total reflection, a blunt one if the film is rough, which moves with the base IOR. So where some base IOR
// is that low, the cosines up to it have a share of the nodes of their own, and it lies at the same node for
// all.
#pragma once

#include "sunbeam/detail/refraction.h"

namespace sunbeam {
inline namespace v1 {

class KneeCosines {
 public:
  // Even cosines.
  KneeCosines() = default;
  // Those of a base IOR.
  KneeCosines(double exterior_ior, double base_ior)
      : critical_(static_cast<float>(critical_cosine(exterior_ior, base_ior))),
        share_(kShare),
        per_cosine_below_(critical_ > 0 ? kShare / critical_ : 0),
        per_cosine_above_((1 - kShare) / (1 - critical_)) {}

  // Returns the place of a cosine, 0 to 1, and the cosine there. Nodes are even in the place.
  float place(float cosine) const {
    return cosine < critical_ ? cosine * per_cosine_below_
                              : share_ + (cosine - critical_) * per_cosine_above_;
  }
  double cosine(double place) const {
    const double critical{critical_}, share{share_};
    return place < share ? critical * place / share
                         : critical + (1 - critical) * (place - share) / (1 - share);
  }

 private:
  static constexpr float kShare = 1.0f / 8;  // as LayeredGrid halves its cosines, a node stays there

  float critical_ = 0, share_ = 0, per_cosine_below_ = 0, per_cosine_above_ = 1;
};

}  // namespace v1
}  // namespace sunbeam
