#include "bake/report/sphere.h"

#include "bake/base/parallel_tasks.h"
#include "sunbeam/core/frame.h"
#include "sunbeam/detail/ggx.h"

namespace sunbeam {
namespace {

// World: x to the right, y up, z towards the viewer.
const Vec3 kView = {0, 0, 1};
const Vec3 kLight = normalize({-0.55, 0.65, 0.6});
constexpr double kIrradiance = 1.5;  // of the light, across its direction
constexpr double kBackground = 0.02;
constexpr double kRadius = 0.96;  // of half the picture
constexpr std::size_t kSkyDirections = 32;
constexpr std::size_t kVisibleNormals = 64;

// Grey, so that the colours are those of the film. A smooth film cannot show a directional light; a soft disc
// takes its place there.
double sky(const Vec3& w) {
  const double horizon = std::exp(-square(w.y / 0.35));
  const double above = w.y > 0 ? 0.45 : 0.06;
  return lerp(horizon, above, 0.8);
}
double soft_light(const Vec3& w) { return 8 * std::exp(-(1 - dot(w, kLight)) / 0.012); }

// Points that fill the unit square evenly (the lattice of the golden ratio).
Point2 even_point(std::size_t k, std::size_t count) {
  const double x = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
  const double y = static_cast<double>(k) * 0.6180339887498949;
  return {x, y - std::floor(y)};
}

class Shading {
 public:
  Shading(const Appearance& skin, const Vec3& normal)
      : skin_(skin),
        frame_(Frame::from_normal_and_tangent(normal, cross({0, 1, 0}, normal))),
        wo_(frame_.to_local(kView)) {}

  Rgb color() const {
    if (wo_.z <= 0) return {};
    return rest() + (skin_.material().is_smooth() ? mirrored() : glossy());
  }

 private:
  // The light and the sky in one call: live walks are shared.
  Rgb rest() const {
    std::vector<Vec3> wi = {frame_.to_local(kLight)};
    for (std::size_t k = 0; k < kSkyDirections; ++k)
      wi.push_back(sample_cosine(even_point(k, kSkyDirections)));
    const std::vector<Rgb> values = skin_.rest(wo_, wi);
    Rgb sum;
    for (std::size_t k = 1; k < wi.size(); ++k) sum += sky(frame_.to_world(wi[k])) * values[k];
    sum *= kPi / kSkyDirections;
    if (wi[0].z > 0) sum += kIrradiance * wi[0].z * values[0];
    return sum;
  }

  Rgb mirrored() const {
    const Vec3 wi = frame_.to_world({-wo_.x, -wo_.y, wo_.z});
    return (sky(wi) + soft_light(wi)) * skin_.dirac(wo_);
  }

  // The first surface of a rough film: the light, and the sky along mirror directions of visible normals.
  Rgb glossy() const {
    const Ggx ggx(skin_.material().roughness);
    Rgb sum;
    for (std::size_t k = 0; k < kVisibleNormals; ++k) {
      const Vec3 h = ggx.sample_visible(wo_, even_point(k, kVisibleNormals));
      const Vec3 wi = reflect(wo_, h);
      if (wi.z <= 0) continue;
      const double weight = wi.z / ggx.reflection_pdf(wo_, h) / kVisibleNormals;
      sum += weight * sky(frame_.to_world(wi)) * skin_.first(wo_, wi);
    }
    const Vec3 light = frame_.to_local(kLight);
    return light.z > 0 ? sum + kIrradiance * light.z * skin_.first(wo_, light) : sum;
  }

  const Appearance& skin_;
  Frame frame_;
  Vec3 wo_;
};

// The rim is blended with the background over one pixel.
Rgb pixel_color(const Appearance& skin, double x, double y, double pixel) {
  const double distance = std::hypot(x, y);
  const double coverage = std::clamp((1 - distance) / pixel + 0.5, 0.0, 1.0);
  if (coverage == 0) return Rgb(kBackground);
  constexpr double kRim = 0.999;  // at 1 the view grazes
  const double shrink = std::min(1.0, kRim / std::max(distance, 1e-9));
  const Vec3 normal = {x * shrink, y * shrink, std::sqrt(1 - square(std::min(distance, kRim)))};
  return coverage * Shading(skin, normal).color() + Rgb((1 - coverage) * kBackground);
}

}  // namespace

Image sphere_image(const Appearance& skin, int pixels, int threads) {
  Image image(pixels, pixels);
  const double pixel = 2 / (kRadius * pixels);
  const auto at = [&](int k) { return (k + 0.5) * pixel - 1 / kRadius; };
  run_parallel_tasks(static_cast<std::size_t>(pixels), threads, {}, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < pixels; ++x) image.set(x, y, pixel_color(skin, at(x), -at(y), pixel));
  });
  return image;
}

}  // namespace sunbeam
