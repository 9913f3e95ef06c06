// The live model behind the BSDF contract: eval and pdf are unbiased estimates from one walk.
#pragma once

#include "bake/live/pfmc.h"
#include "sunbeam/bsdf.h"

namespace sunbeam {

class LiveBsdf final : public Bsdf {
 public:
  explicit LiveBsdf(const Material& material) : LiveBsdf(material, Wavelengths::rgb3(material)) {}
  LiveBsdf(const Material& material, Wavelengths wavelengths);

  Rgb eval(const Vec3& wo, const Vec3& wi, Rng& rng) const override;
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override { return pfmc_.sample(wo, rng); }
  double pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const override {
    return pfmc_.estimate_pdf(wo, wi, rng);
  }

  // The first-surface density exactly, and for the rest the chance of passing a smooth film at wo times a
  // density proportional to T(wi) cos(wi): what a smooth film over a white base without pigment gives.
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override;

 private:
  double mean_transmittance(double cosine) const {
    return std::max(0.0, 1 - mean(pfmc_.film_reflectance(cosine)));
  }

  Pfmc pfmc_;
  double transmitted_cosine_;  // Int T(w) cos(w) dw
};

}  // namespace sunbeam
