// A table of values and nothing else: directions are drawn by the cosine alone.
#pragma once

#include "sunbeam/bsdf.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

class PlainTable : public Bsdf {
 public:
  Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override {
    return wo.z > 0 && wi.z > 0 ? value(wo, wi) : Rgb();
  }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    if (wo.z <= 0) return {};
    const Vec3 wi = sample_cosine({rng.uniform(), rng.uniform()});
    return BsdfSample{wi, kPi * eval(wo, wi, rng), false, cosine_pdf(wi.z)};
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override { return wo.z > 0 ? cosine_pdf(wi.z) : 0; }

  virtual std::size_t bytes() const = 0;  // as stored

 private:
  virtual Rgb value(const Vec3& wo, const Vec3& wi) const = 0;  // both above the horizon
};

// Tables are filled at nodes that lie on the horizon or below, where no BSDF has a value: the nearest
// direction that has one.
inline Vec3 above_horizon(const Vec3& w) {
  constexpr double kLowestCosine = 0.002;
  return w.z >= kLowestCosine ? w : normalize({w.x, w.y, kLowestCosine});
}

}  // namespace sunbeam
