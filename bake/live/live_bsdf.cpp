#include "bake/live/live_bsdf.h"

namespace sunbeam {

LiveBsdf::LiveBsdf(const Material& material, Wavelengths wavelengths)
    : pfmc_(material, std::move(wavelengths)), transmitted_cosine_(0) {
  constexpr int kNodes = 32;  // midpoints in sin^2; the density only steers MIS weights
  for (int i = 0; i < kNodes; ++i)
    transmitted_cosine_ += kPi / kNodes * mean_transmittance(std::sqrt((i + 0.5) / kNodes));
}

Rgb LiveBsdf::eval(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return pfmc_.first(wo, wi) + pfmc_.estimate_rest(wo, wi, rng);
}

double LiveBsdf::mis_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  const double rest = mean_transmittance(wo.z) * mean_transmittance(wi.z) * wi.z / transmitted_cosine_;
  return pfmc_.first_pdf(wo, wi) + rest;
}

}  // namespace sunbeam
