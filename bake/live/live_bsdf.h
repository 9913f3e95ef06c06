// This file puts the live model behind the BSDF contract: eval and pdf are unbiased estimates from one packet
// of walks.
//
// With many wavelengths every call draws kHeroes of them at random, in proportion to their share in colour
// and spread evenly over it (Wilkie et al. 2014: one random hero, the others at fixed distances from it), and
// weighs them accordingly: unbiased in RGB, and its colour noise averages out. Heroes carry the rest; the
// first surface is always the whole spectrum.
#pragma once

#include "bake/live/pfmc.h"
#include "sunbeam/bsdf.h"

namespace sunbeam {

class LiveBsdf final : public Bsdf {
 public:
  static constexpr int kHeroes = 4;

  LiveBsdf(const Material& material, const Wavelengths& wavelengths,
           Technique technique = Technique::unidirectional);
  // Carries the paper's three wavelengths.
  explicit LiveBsdf(const Material& material) : LiveBsdf(material, Wavelengths::rgb3(material)) {}

  Rgb eval(const Vec3& wo, const Vec3& wi, Rng& rng) const override;
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override;
  double pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const override;

  // Returns the first-surface density plus, for the rest, the chance of entering a smooth film at wo times
  // the density of leaving it after a visit of the base. Both come from tables over the cosine. How far it is
  // off is measured in docs/theory/live.md.
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override;
  bool is_isotropic() const override { return is_isotropic_; }

 private:
  template <class Use>
  auto with_heroes(Rng& rng, Use use) const;

  static constexpr int kIntervals = 128;  // of the cosine
  using Curve = std::array<double, kIntervals + 1>;
  static double look_up(const Curve& curve, double cosine);

  Pfmc pfmc_;
  Ggx ggx_;
  bool is_smooth_, is_isotropic_;
  Technique technique_;
  Curve reflect_chance_;                            // of sample(), from outside
  Curve leaving_;                                   // of what comes from below: density over wi, 1/sr
  std::array<double, kMostWavelengths + 1> share_;  // cumulative, of the wavelengths
};

}  // namespace sunbeam
