// The renderer around the integrator: threads, seeds, statistics, failure.
#include "runtime/tracer/render.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "tests/render/support.h"

namespace sunbeam {
namespace {

Scene small_scene() {
  return scene_from(R"(
    [camera]
    position = [0, -5, 2]
    look_at = [0, 0, 0.5]
    [render]
    width = 50
    height = 35
    spp = 4
    [environment]
    color = [0.1, 0.2, 0.3]
    [[light]]
    type = "quad"
    center = [0, 0, 3]
    edge_u = [0, 1, 0]
    edge_v = [1, 0, 0]
    radiance = 9
    [[material]]
    name = "grey"
    type = "diffuse"
    [[object]]
    type = "torus"
    center = [0, 0, 0.5]
    major_radius = 1
    minor_radius = 0.4
    rotate_deg = [60, 0, 20]
    material = "grey"
    [[object]]
    type = "plane"
    material = "grey"
  )");
}

// A BSDF whose eval and sample do what they are told.
class Broken final : public Bsdf {
 public:
  explicit Broken(bool throws) : throws_(throws) {}
  Rgb eval(const Vec3&, const Vec3&, Rng&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3&, Rng&) const override {
    if (throws_) throw std::domain_error("broken BSDF");
    return BsdfSample{{0, 0, 1}, Rgb(std::numeric_limits<double>::quiet_NaN()), false};
  }
  double pdf(const Vec3&, const Vec3&, Rng&) const override { return 0; }
  double mis_pdf(const Vec3&, const Vec3&) const override { return 0; }

 private:
  bool throws_;
};

TEST(Render, BitsDoNotDependOnTheThreadCount) {
  const Scene scene = small_scene();
  const Lambert lambert(Rgb(0.7));
  const RenderResult one = render_with(scene, lambert, {.threads = 1, .seed = 5});
  for (const int threads : {2, 3, 0}) {
    const RenderResult other = render_with(scene, lambert, {.threads = threads, .seed = 5});
    EXPECT_EQ(one.mean.rgb, other.mean.rgb) << threads << " threads";
    EXPECT_EQ(one.variance.rgb, other.variance.rgb) << threads << " threads";
  }
  EXPECT_NE(one.mean.rgb, render_with(scene, lambert, {.threads = 1, .seed = 6}).mean.rgb);
}

TEST(Render, StatisticsCountWhatWasDone) {
  const RenderResult result = render_with(small_scene(), Lambert(Rgb(0.7)), {});
  EXPECT_EQ(result.mean.width, 50);
  EXPECT_EQ(result.mean.height, 35);
  EXPECT_EQ(result.stats.samples, 50u * 35 * 4);
  EXPECT_GT(result.stats.vertices, result.stats.samples / 2);  // 1.00 on average
  EXPECT_GT(result.stats.rays, result.stats.vertices);
  EXPECT_EQ(result.stats.bad_samples, 0u);
  EXPECT_GT(result.stats.seconds, 0);
  EXPECT_GT(result.stats.cpu_seconds, 0);
  EXPECT_GT(result.stats.peak_rss_mb, 1);
  EXPECT_NEAR(result.stats.samples_per_second * result.stats.seconds, 7000, 1e-3);
}

TEST(Render, VarianceIsThatOfTheMean) {
  // The spread of one pixel over independent seeds against the variance each run claims for itself. 400 runs:
  // the ratio has a standard deviation near 0.1 (skewed samples), so 0.6 to 1.6 is beyond 4 of them: 1e-4.
  const Scene scene = small_scene();
  const Lambert lambert(Rgb(0.7));
  double sum = 0, squares = 0, claimed = 0;
  const int runs = 400;
  for (int seed = 0; seed < runs; ++seed) {
    const RenderResult result = render_with(
        scene, lambert,
        {.width = 1, .height = 1, .spp = 64, .threads = 1, .seed = static_cast<std::uint64_t>(seed)});
    sum += result.mean.rgb[0];
    squares += square(result.mean.rgb[0]);
    claimed += result.variance.rgb[0] / runs;
  }
  const double seen = (squares - sum * sum / runs) / (runs - 1);
  EXPECT_GT(claimed, 0);
  EXPECT_GT(seen / claimed, 0.6);
  EXPECT_LT(seen / claimed, 1.6);
}

TEST(Render, SamplesThatAreNotFiniteAreCountedAndBlack) {
  const RenderResult result = render_with(small_scene(), Broken(false), {});
  EXPECT_GT(result.stats.bad_samples, 0u);
  EXPECT_LT(result.stats.bad_samples, result.stats.samples);  // the sky is fine
  for (const float value : result.mean.rgb) ASSERT_TRUE(std::isfinite(value));
}

TEST(Render, ExceptionsReachTheCaller) {
  const auto fail = [](double) { throw std::runtime_error("stop"); };
  EXPECT_THROW(render_with(small_scene(), Broken(true), {}), std::domain_error);
  EXPECT_THROW(render_with(small_scene(), Lambert(Rgb(0.5)), {.threads = 2, .progress = fail}),
               std::runtime_error);
}

TEST(Render, ProgressRisesToOne) {
  std::vector<double> fractions;
  render_with(small_scene(), Lambert(Rgb(0.5)), {.progress = [&](double f) { fractions.push_back(f); }});
  ASSERT_EQ(fractions.size(), 4u * 3);  // tiles of 16 x 16
  for (std::size_t i = 1; i < fractions.size(); ++i) EXPECT_GT(fractions[i], fractions[i - 1]);
  EXPECT_EQ(fractions.back(), 1);
}

TEST(Render, BadSettingsAreRefused) {
  const Scene scene = small_scene();
  const Lambert lambert(Rgb(0.5));
  EXPECT_EQ(error_of([&] { render_with(scene, lambert, {.spp = -1}); }),
            "render settings: spp: found -1; allowed: 1 to 16777216");
  EXPECT_EQ(error_of([&] { render_with(scene, lambert, {.threads = -2}); }),
            "render settings: threads: found -2; allowed: 0 to 4096");
  EXPECT_EQ(error_of([&] { render(scene, {}, {}); }),
            "render: found 0 BSDFs; allowed: one for each of 1 materials");
  EXPECT_EQ(error_of([&] { render(scene, std::vector<const Bsdf*>{nullptr}, {}); }),
            "render: material \"grey\" has no BSDF");
}

}  // namespace
}  // namespace sunbeam
