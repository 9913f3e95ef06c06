// This is the diffuse BSDF: f = albedo / pi.
#pragma once

#include "sunbeam/bsdf.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {

class Lambert final : public Bsdf {
 public:
  explicit Lambert(const Rgb& albedo) : albedo_(albedo) {}

  Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override {
    return wo.z > 0 && wi.z > 0 ? albedo_ * kInvPi : Rgb();
  }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    return sample(wo, random3(rng), rng);
  }
  std::optional<BsdfSample> sample(const Vec3& wo, const Random3& u, Rng&) const override {
    if (wo.z <= 0) return {};
    const Vec3 wi = sample_cosine({u[1], u[2]});
    return BsdfSample{wi, albedo_, false, cosine_pdf(wi.z)};
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override { return wo.z > 0 ? cosine_pdf(wi.z) : 0; }
  bool is_isotropic() const override { return true; }

 private:
  Rgb albedo_;
};

}  // namespace sunbeam
