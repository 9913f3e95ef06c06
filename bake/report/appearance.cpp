#include "bake/report/appearance.h"

#include <fmt/format.h>

namespace sunbeam {

std::vector<Rgb> TableAppearance::rest(const Vec3& a, std::span<const Vec3> b) const {
  std::vector<Rgb> values;
  for (const Vec3& w : b) values.push_back(bsdf_.rest(a, w));
  return values;
}

LiveAppearance::LiveAppearance(const Material& material, const Spectrum& spectrum, int estimates)
    : material_(material),
      estimator_(automatic_for_render(material).estimator),
      estimates_(estimates),
      pfmc_(material, spectrum.wavelengths(material)),
      to_rec709_(rgb_to_rgb(spectrum.color_space(), ColorSpace::rec709)) {
  if (estimator_ == Estimator::exact) exact_.emplace(material, spectrum.wavelengths(material));
}

std::vector<Rgb> LiveAppearance::rest(const Vec3& a, std::span<const Vec3> b) const {
  std::vector<Rgb> values;
  if (exact_)
    for (const Vec3& w : b) values.push_back(exact_->rest(a, w));
  else
    values = walked_rest(a, b);
  for (Rgb& value : values) value = to_rec709_ * value;
  return values;
}

std::vector<Rgb> LiveAppearance::walked_rest(const Vec3& a, std::span<const Vec3> b) const {
  std::vector<Rgb> sums(b.size());
  Rng rng(/*seed=*/1, /*stream=*/0);
  for (int k = 0; k < estimates_; ++k) pfmc_.add_rest(a, b, rng, sums, technique_of(estimator_));
  for (Rgb& sum : sums) sum = sum / estimates_;
  return sums;
}

std::string live_method(const Material& material, int estimates) {
  const Estimator estimator = automatic_for_render(material).estimator;
  if (estimator == Estimator::exact) return "exact-quadrature, without noise";
  return fmt::format("{}, {} estimates a direction, a little noisy", name_of(estimator), estimates);
}

}  // namespace sunbeam
