// What the tracer tests share: scenes from text and BSDFs with one property each.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "runtime/tracer/lambert.h"
#include "runtime/tracer/render.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/core/error.h"
#include "tests/support/error_of.h"
#include "tests/support/scratch_folder.h"

namespace sunbeam {

using test::error_of;

inline Scene scene_from(const std::string& text) { return read_scene(ConfigTable::parse(text, "test.toml")); }

// A plane of albedo 0.5 at z = 0, seen from the side through a pixel so narrow (0.02 degrees, 2 mm) that all
// its samples meet the origin as far as lighting is concerned.
inline const std::string kPlane = R"(
[camera]
position = [4, 0, 2]
look_at = [0, 0, 0]
fov_deg = 0.1
[render]
width = 4
height = 4
max_bounces = 1
[[material]]
name = "grey"
type = "diffuse"
albedo = 0.5
[[object]]
type = "plane"
material = "grey"
half_size = 2
)";

// A perfect mirror of reflectance `albedo`.
class Mirror final : public Bsdf {
 public:
  explicit Mirror(double albedo) : albedo_(albedo) {}
  Rgb eval(const Vec3&, const Vec3&, Rng&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng&) const override {
    return BsdfSample{{-wo.x, -wo.y, wo.z}, Rgb(albedo_), true, 0};
  }
  double pdf(const Vec3&, const Vec3&, Rng&) const override { return 0; }
  double mis_pdf(const Vec3&, const Vec3&) const override { return 0; }

 private:
  double albedo_;
};

// Lambert with another MIS density: huge, and only BSDF samples count; tiny, and only light samples do.
class LambertWithMisPdf final : public Bsdf {
 public:
  LambertWithMisPdf(double albedo, double mis_pdf) : lambert_(Rgb(albedo)), mis_pdf_(mis_pdf) {}
  Rgb eval(const Vec3& wo, const Vec3& wi, Rng& rng) const override { return lambert_.eval(wo, wi, rng); }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    auto sample = lambert_.sample(wo, rng);
    if (sample) sample->mis_pdf = mis_pdf_;
    return sample;
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const override { return lambert_.pdf(wo, wi, rng); }
  double mis_pdf(const Vec3&, const Vec3&) const override { return mis_pdf_; }

 private:
  Lambert lambert_;
  double mis_pdf_;
};

inline RenderResult render_with(const Scene& scene, const Bsdf& bsdf, const RenderSettings& settings) {
  return render(scene, std::vector<SurfaceBsdf>(scene.materials.size(), &bsdf), settings);
}

// Mean of all pixels and channels of a grey picture, and the standard error of that mean. Pixels are
// independent; the channels of one are equal.
struct Estimate {
  double mean = 0, standard_error = 0;
};
inline Estimate grey_estimate(const RenderResult& result) {
  double sum = 0, variance = 0;
  for (const float value : result.mean.rgb) sum += value;
  for (const float value : result.variance.rgb) variance += value;
  const double pixels = static_cast<double>(result.mean.rgb.size()) / 3;
  return {sum / (3 * pixels), std::sqrt(variance / 3) / pixels};
}

}  // namespace sunbeam
