// The weights of multiple importance sampling by value: the power heuristic, p^2 / (p^2 + q^2).
//
// A small disc of light stands above the plane, and a BSDF either draws its direction or is asked for it,
// never both: what the picture shows is one technique's part, without noise.
#include "tests/render/support.h"

namespace sunbeam {
namespace {

constexpr double kDegrees = 2, kIrradiance = 5;

double light_pdf() { return 1 / (2 * kPi * (1 - std::cos(kDegrees * kPi / 360))); }

// Draws the direction of the light with throughput 1, or has the value 1 there.
class OneTechnique final : public Bsdf {
 public:
  OneTechnique(bool samples, double density) : samples_(samples), density_(density) {}
  Rgb eval(const Vec3&, const Vec3&, Rng&) const override { return Rgb(samples_ ? 0 : 1); }
  std::optional<BsdfSample> sample(const Vec3&, Rng&) const override {
    if (!samples_) return {};
    return BsdfSample{{0, 0, 1}, Rgb(1), false, density_};
  }
  double pdf(const Vec3&, const Vec3&, Rng&) const override { return density_; }
  double mis_pdf(const Vec3&, const Vec3&) const override { return density_; }

 private:
  bool samples_;
  double density_;
};

double brightness(bool samples, double density) {
  const Scene scene =
      scene_from(kPlane + "[[light]]\ntype = 'directional'\ntowards = [0, 0, 1]\nirradiance = " +
                 std::to_string(kIrradiance) + "\nangle_deg = " + std::to_string(kDegrees) + "\n");
  return grey_estimate(render_with(scene, OneTechnique(samples, density), {.spp = 4})).mean;
}

// A disc's radiance is its irradiance over its projected solid angle.
TEST(PowerHeuristic, OfDirectionsThatTheBsdfDraws) {
  const double radiance = kIrradiance / (kPi * square(std::sin(kDegrees * kPi / 360)));
  for (const double ratio : {0.5, 1.0, 3.0}) {
    const double expected = radiance * square(ratio) / (1 + square(ratio));
    EXPECT_NEAR(brightness(true, ratio * light_pdf()), expected, 1e-3 * expected) << ratio;
  }
}

// Cosines over the disc are within 2e-4 of 1.
TEST(PowerHeuristic, OfDirectionsThatTheLightDraws) {
  for (const double ratio : {0.5, 1.0, 3.0}) {
    const double expected = kIrradiance / (1 + square(ratio));
    EXPECT_NEAR(brightness(false, ratio * light_pdf()), expected, 1e-3 * expected) << ratio;
  }
}

}  // namespace
}  // namespace sunbeam
