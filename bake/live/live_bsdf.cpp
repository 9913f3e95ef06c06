#include "bake/live/live_bsdf.h"

#include <algorithm>

#include "sunbeam/detail/bracket.h"

namespace sunbeam {

LiveBsdf::LiveBsdf(const Material& material, const Wavelengths& wavelengths, Technique technique)
    : pfmc_(material, wavelengths),
      ggx_(material.roughness),
      is_smooth_(material.is_smooth()),
      is_isotropic_(material.roughness.is_isotropic()),
      technique_(technique),
      share_{} {
  for (int k = 0; k < pfmc_.wavelengths(); ++k) share_[k + 1] = share_[k] + pfmc_.importance(k);
  for (int i = 0; i <= kIntervals; ++i) {
    const double cosine = static_cast<double>(i) / kIntervals;
    reflect_chance_[i] = pfmc_.reflect_chance(cosine);
    leaving_[i] = pfmc_.leaving_shape(cosine);
  }
  double whole = 0;  // Int leaving dwi = 2 pi Int leaving dcos, by trapezia as look_up() has it
  for (int i = 0; i < kIntervals; ++i) whole += kPi / kIntervals * (leaving_[i] + leaving_[i + 1]);
  for (double& value : leaving_) value /= std::max(whole, 1e-300);
}

// Calls use(model) with the model at heroes drawn from `rng`, or at all wavelengths if they are few.
template <class Use>
auto LiveBsdf::with_heroes(Rng& rng, Use use) const {
  const int count = pfmc_.wavelengths();
  if (count <= kHeroes) return use(pfmc_);
  std::array<Pfmc::Pick, kHeroes> picks;
  const double start = rng.uniform();
  for (int i = 0; i < kHeroes; ++i) {
    const double at = (start + i) / kHeroes;
    const auto above = std::upper_bound(share_.begin() + 1, share_.begin() + count, at);
    const int k = static_cast<int>(above - share_.begin()) - 1;
    picks[i] = {k, 1 / (kHeroes * pfmc_.importance(k))};
  }
  return use(pfmc_.at(picks));
}

Rgb LiveBsdf::eval(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return pfmc_.first(wo, wi) +
         with_heroes(rng, [&](const Pfmc& model) { return model.estimate_rest(wo, wi, rng, technique_); });
}

std::optional<BsdfSample> LiveBsdf::sample(const Vec3& wo, Rng& rng) const {
  auto sample = with_heroes(rng, [&](const Pfmc& model) { return pfmc_.sample(wo, rng, model); });
  if (sample && !sample->is_dirac) sample->mis_pdf = mis_pdf(wo, sample->wi);
  return sample;
}

double LiveBsdf::pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  return with_heroes(rng, [&](const Pfmc& model) { return pfmc_.estimate_pdf(wo, wi, rng, model); });
}

double LiveBsdf::look_up(const Curve& curve, double cosine) {
  const Bracket at = even_bracket(cosine, curve.size());
  return lerp(at.upper_weight, curve[at.lower], curve[at.upper]);
}

double LiveBsdf::mis_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  const double rest = (1 - look_up(reflect_chance_, wo.z)) * look_up(leaving_, wi.z);
  if (is_smooth_) return rest;
  const Vec3 h = normalize(wo + wi);
  return ggx_.reflection_pdf(wo, h) * look_up(reflect_chance_, dot(wo, h)) + rest;
}

}  // namespace sunbeam
