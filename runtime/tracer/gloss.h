// This is the BSDF of a smooth or rough dielectric over black: eyes, wet stone. What enters is absorbed.
//
// f = F(wo.h) D(h) G2(wo, wi) / (4 cos_o cos_i) of Walter et al. 2007, F unpolarised Fresnel (Cook and
// Torrance 1982), D and G2 those of Ggx. It samples visible normals; those that mirror below the horizon are
// empty.
#pragma once

#include "sunbeam/bsdf.h"
#include "sunbeam/detail/ggx.h"

namespace sunbeam {

class Gloss final : public Bsdf {
 public:
  // Takes ior > 1 and as roughness the GGX alpha, > 0.
  Gloss(double ior, double roughness) : ior_(ior), ggx_({roughness, roughness}) {}

  Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    const Vec3 h = normalize(wo + wi);
    return Rgb(fresnel(dot(wo, h)) * ggx_.reflection(wo, wi, h));
  }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    return sample(wo, random3(rng), rng);
  }
  std::optional<BsdfSample> sample(const Vec3& wo, const Random3& u, Rng&) const override {
    if (wo.z <= 0) return {};
    const Vec3 h = ggx_.sample_visible(wo, {u[1], u[2]});
    const Vec3 wi = reflect(wo, h);
    if (wi.z <= 0) return {};
    return BsdfSample{wi, Rgb(fresnel(dot(wo, h)) * ggx_.g2_over_g1(wo, wi)), false,
                      ggx_.reflection_pdf(wo, h)};
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override {
    return wo.z > 0 && wi.z > 0 ? ggx_.reflection_pdf(wo, normalize(wo + wi)) : 0;
  }
  bool is_isotropic() const override { return true; }

 private:
  double fresnel(double cosine) const {
    const double g = std::sqrt(square(ior_) - 1 + square(cosine));
    const double s = (g - cosine) / (g + cosine),
                 p = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
    return 0.5 * square(s) * (1 + square(p));
  }

  double ior_;
  Ggx ggx_;
};

}  // namespace sunbeam
