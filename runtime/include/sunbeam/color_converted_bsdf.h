// This adapter serves a renderer whose linear colour space is not that of a live model. Tables need none:
// their look-ups are bound to the renderer's space (bind_options.h).
//
// Values and throughputs go through the matrix rgb_to_rgb(from, to), which keeps greys; densities and
// directions stay as they are. Components keep their sign: a colour that `to` cannot show has a negative one.
#pragma once

#include <utility>

#include "sunbeam/bsdf.h"
#include "sunbeam/core/color_space.h"

namespace sunbeam {
inline namespace v1 {

// `Inner` is any Bsdf; it is kept by value.
template <class Inner>
class ColorConvertedBsdf final : public Bsdf {
 public:
  ColorConvertedBsdf(Inner bsdf, const ColorMatrix& matrix) : bsdf_(std::move(bsdf)), matrix_(matrix) {}
  ColorConvertedBsdf(Inner bsdf, ColorSpace from, ColorSpace to)
      : ColorConvertedBsdf(std::move(bsdf), rgb_to_rgb(from, to)) {}

  Rgb eval(const Vec3& wo, const Vec3& wi, Rng& rng) const override {
    return matrix_ * bsdf_.eval(wo, wi, rng);
  }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    auto sample = bsdf_.sample(wo, rng);
    if (sample) sample->throughput = matrix_ * sample->throughput;
    return sample;
  }
  std::optional<BsdfSample> sample(const Vec3& wo, const Random3& u, Rng& rng) const override {
    const Bsdf& inner = bsdf_;  // its class may hide this overload
    auto sample = inner.sample(wo, u, rng);
    if (sample) sample->throughput = matrix_ * sample->throughput;
    return sample;
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const override { return bsdf_.pdf(wo, wi, rng); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override { return bsdf_.mis_pdf(wo, wi); }
  EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const override {
    const EvalPdf value = bsdf_.eval_pdf(wo, wi, rng);
    return {matrix_ * value.f, value.pdf};
  }
  EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, Rng& rng) const override {
    EvalAndSample both = bsdf_.eval_and_sample(wo, wi, rng);
    both.eval.f = matrix_ * both.eval.f;
    if (both.sample) both.sample->throughput = matrix_ * both.sample->throughput;
    return both;
  }
  bool is_isotropic() const override { return bsdf_.is_isotropic(); }

 private:
  Inner bsdf_;
  ColorMatrix matrix_;
};

}  // namespace v1
}  // namespace sunbeam
