// The renderer around the integrator: threads, seeds, statistics, failure.
#include "runtime/tracer/render.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "sunbeam/detail/text.h"
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

// The camera of a scene at a height of 2 over the origin, u to the right and v up; more lines of [render] may
// follow.
std::string from_above(double fov_deg, int width, int height) {
  return "[camera]\nposition = [0, 0, 2]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nfov_deg = " +
         to_text(fov_deg) + "\n[render]\nwidth = " + std::to_string(width) +
         "\nheight = " + std::to_string(height) + "\n";
}

// A BSDF whose eval and sample do what they are told.
class Broken final : public Bsdf {
 public:
  explicit Broken(bool throws, double throughput = std::numeric_limits<double>::quiet_NaN())
      : throws_(throws), throughput_(throughput) {}
  Rgb eval(const Vec3&, const Vec3&, Rng&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3&, Rng&) const override {
    if (throws_) throw std::domain_error("broken BSDF");
    return BsdfSample{{0, 0, 1}, Rgb(throughput_), false, 0};
  }
  double pdf(const Vec3&, const Vec3&, Rng&) const override { return 0; }
  double mis_pdf(const Vec3&, const Vec3&) const override { return 0; }

 private:
  bool throws_;
  double throughput_;
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
  EXPECT_GT(result.stats.build_cpu_seconds, 0);
  EXPECT_LE(result.stats.build_cpu_seconds, result.stats.cpu_seconds);
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

// What is finite as a double may be infinite as a float, and so may its square, which the variance holds.
TEST(Render, SamplesThatPicturesCannotHoldAreCountedAndBlack) {
  for (const double throughput : {1e300, 1e39, 1e20, -1e20}) {
    const RenderResult result = render_with(small_scene(), Broken(false, throughput), {.first_hits = true});
    EXPECT_GT(result.stats.bad_samples, 0u);
    EXPECT_LT(result.stats.bad_samples, result.stats.samples);
    for (const float value : result.mean.rgb) ASSERT_TRUE(std::isfinite(value));
    for (const float value : result.variance.rgb) ASSERT_TRUE(std::isfinite(value));
    for (const float value : result.first_hits->albedo.rgb) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(Render, ExceptionsReachTheCaller) {
  const auto fail = [](const RenderResult&) -> bool { throw std::runtime_error("stop"); };
  EXPECT_THROW(render_with(small_scene(), Broken(true), {}), std::domain_error);
  EXPECT_THROW(render_with(small_scene(), Lambert(Rgb(0.5)), {.threads = 2, .monitor = fail}),
               std::runtime_error);
}

TEST(Render, MonitorSeesTheWorkRiseToItsEnd) {
  std::vector<double> fractions;
  const auto note = [&](const RenderResult& so_far) {
    fractions.push_back(so_far.stats.fraction);
    return true;
  };
  render_with(small_scene(), Lambert(Rgb(0.5)), {.monitor = note});
  ASSERT_GE(fractions.size(), 7u * 5);  // tiles of 8 x 8, one pass at least
  for (std::size_t i = 1; i < fractions.size(); ++i) EXPECT_GT(fractions[i], fractions[i - 1]);
  EXPECT_EQ(fractions.back(), 1);
}

TEST(Render, MonitorStopsAndThePictureSoFarIsWhole) {
  int calls = 0;
  const auto stop_later = [&](const RenderResult&) { return ++calls < 60; };  // in the second pass
  const RenderResult result =
      render_with(small_scene(), Lambert(Rgb(0.5)), {.spp = 1000, .monitor = stop_later});
  EXPECT_TRUE(result.stats.stopped);
  EXPECT_LT(result.stats.fraction, 1);
  for (const float count : result.sample_count) EXPECT_GE(count, 1);
}

// A crop holds the pixels of the whole picture.
TEST(Render, CropIsAPartOfTheWhole) {
  const Scene scene = small_scene();
  const RenderResult whole = render_with(scene, Lambert(Rgb(0.5)), {.first_hits = true});
  const RenderResult part =
      render_with(scene, Lambert(Rgb(0.5)),
                  {.crop = PixelWindow{.x0 = 11, .y0 = 3, .x1 = 40, .y1 = 20}, .first_hits = true});
  ASSERT_EQ(part.mean.width, 29);
  ASSERT_EQ(part.mean.height, 17);
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 29; ++x) {
      ASSERT_EQ(part.mean.get(x, y), whole.mean.get(x + 11, y + 3));
      ASSERT_EQ(part.variance.get(x, y), whole.variance.get(x + 11, y + 3));
      ASSERT_EQ(part.first_hits->shading_normal.get(x, y),
                whole.first_hits->shading_normal.get(x + 11, y + 3));
    }
}

TEST(Render, CropOutsideThePictureIsRefused) {
  for (const PixelWindow crop :
       {PixelWindow{.x0 = 0, .y0 = 0, .x1 = 51, .y1 = 10}, PixelWindow{.x0 = 5, .y0 = 0, .x1 = 5, .y1 = 10},
        PixelWindow{.x0 = -1, .y0 = 0, .x1 = 5, .y1 = 10}})
    EXPECT_NE(error_of([&] { render_with(small_scene(), Lambert(Rgb(0.5)), {.crop = crop}); }).find("crop"),
              std::string::npos);
}

// The samples of a resumed picture are those of an uninterrupted one; only rounding to float comes between.
TEST(Render, ResumedPictureEqualsTheUninterruptedOne) {
  const Scene scene = small_scene();
  const RenderResult first = render_with(scene, Lambert(Rgb(0.5)), {.spp = 3, .first_hits = true});
  const RenderResult resumed =
      render_with(scene, Lambert(Rgb(0.5)), {.spp = 10, .first_hits = true, .resume = &first});
  const RenderResult whole = render_with(scene, Lambert(Rgb(0.5)), {.spp = 10, .first_hits = true});
  EXPECT_EQ(resumed.stats.samples, 50u * 35 * 7);
  EXPECT_EQ(resumed.sample_count, whole.sample_count);
  for (std::size_t i = 0; i < whole.mean.rgb.size(); ++i) {
    ASSERT_NEAR(resumed.mean.rgb[i], whole.mean.rgb[i], 1e-5 * (1 + whole.mean.rgb[i]));
    ASSERT_NEAR(resumed.variance.rgb[i], whole.variance.rgb[i], 1e-4 * (1e-3 + whole.variance.rgb[i]));
    ASSERT_NEAR(resumed.first_hits->albedo.rgb[i], whole.first_hits->albedo.rgb[i], 1e-5);
  }
}

// A plane that fills the picture, under a relief that turns its normals, of a film that varies: every layer
// has values of its own.
Scene scene_of_all_layers() {
  return scene_from(from_above(50, 8, 6) + R"(
[environment]
color = 1
[[material]]
name = "m"
type = "skin"
film_thickness_nm = {from = 0, to = 1000, ramp = [1, 0]}
scales = { around = 5, height = 0.5 }
[[object]]
type = "plane"
half_size = 4
rotate_deg = [0, 20, 0]
material = "m"
)");
}

TEST(Render, ResumedFirstHitsEqualTheUninterruptedOnes) {
  const Scene scene = scene_of_all_layers();
  const RenderResult first = render_with(scene, Lambert(Rgb(0.5)), {.spp = 3, .first_hits = true});
  const FirstHits resumed =
      *render_with(scene, Lambert(Rgb(0.5)), {.spp = 10, .first_hits = true, .resume = &first}).first_hits;
  const FirstHits whole = *render_with(scene, Lambert(Rgb(0.5)), {.spp = 10, .first_hits = true}).first_hits;
  double turned = 0;
  for (std::size_t i = 0; i < whole.albedo.rgb.size(); ++i) {
    EXPECT_NEAR(resumed.albedo.rgb[i], whole.albedo.rgb[i], 1e-5);
    EXPECT_NEAR(resumed.shading_normal.rgb[i], whole.shading_normal.rgb[i], 1e-5);
    EXPECT_NEAR(resumed.geometric_normal.rgb[i], whole.geometric_normal.rgb[i], 1e-5);
    turned = std::max<double>(turned, std::abs(whole.shading_normal.rgb[i] - whole.geometric_normal.rgb[i]));
  }
  EXPECT_GT(turned, 0.1);
  for (std::size_t i = 0; i < whole.depth.size(); ++i) {
    EXPECT_NEAR(resumed.depth[i], whole.depth[i], 1e-5);
    EXPECT_NEAR(resumed.film_thickness_nm[i], whole.film_thickness_nm[i], 1e-3);
    EXPECT_GT(whole.depth[i], 1);
  }
  EXPECT_GT(std::abs(whole.film_thickness_nm[0] - whole.film_thickness_nm[7]), 100);
}

TEST(Render, TimeLimitEndsTheRenderWithEveryPixelSampled) {
  const RenderResult result = render_with(small_scene(), Lambert(Rgb(0.5)), {.spp = 1 << 24, .seconds = 0.2});
  EXPECT_FALSE(result.stats.stopped);
  EXPECT_LT(result.stats.cpu_seconds, 2);  // on a busy machine it may end late
  for (const float count : result.sample_count) EXPECT_GE(count, 1);
}

// Noise asked for is noise got: the standard error over independent pictures, not the one each claims.
TEST(Render, NoiseLimitIsMet) {
  const Scene scene = small_scene();
  constexpr int kRuns = 24;
  constexpr double kNoise = 0.05;
  std::vector<double> sum(50 * 35 * 3), squares(sum.size());
  double brightness = 0, samples = 0;
  for (int run = 0; run < kRuns; ++run) {
    const RenderResult result = render_with(
        scene, Lambert(Rgb(0.5)), {.spp = 1 << 14, .seed = static_cast<std::uint64_t>(run), .noise = kNoise});
    samples += static_cast<double>(result.stats.samples) / kRuns;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += result.mean.rgb[i];
      squares[i] += square(result.mean.rgb[i]);
    }
  }
  double variance = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    brightness += sum[i] / kRuns / static_cast<double>(sum.size());
    variance += (squares[i] - square(sum[i]) / kRuns) / (kRuns - 1) / static_cast<double>(sum.size());
  }
  EXPECT_LT(std::sqrt(variance), 1.1 * kNoise * brightness);  // 10 % = 13 sigma of this estimate
  EXPECT_LT(samples, 50 * 35 * 4096.0);                       // and stopped far below the limit
}

TEST(Render, NoiseLimitDoesNotDependOnThreads) {
  const auto samples_of = [](int threads) {
    return render_with(small_scene(), Lambert(Rgb(0.5)), {.spp = 256, .threads = threads, .noise = 0.1})
        .sample_count;
  };
  EXPECT_EQ(samples_of(1), samples_of(3));
}

TEST(Render, FirstHitsOfAPlane) {
  const Scene scene = scene_from(from_above(1, 8, 8) + R"(
spp = 4
[[material]]
name = "m"
type = "diffuse"
albedo = [0.25, 0.5, 0.75]
[[object]]
type = "plane"
material = "m"
)");
  const RenderResult result = render_with(scene, Lambert({0.25, 0.5, 0.75}), {.first_hits = true});
  const FirstHits& first = *result.first_hits;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(first.albedo.get(x, y), Rgb(0.25, 0.5, 0.75));
      EXPECT_EQ(first.shading_normal.get(x, y), Rgb(0, 0, 1));
      EXPECT_EQ(first.geometric_normal.get(x, y), Rgb(0, 0, 1));
      EXPECT_NEAR(first.depth[static_cast<std::size_t>(8 * y + x)], 2, 1e-3);
    }
}

// A plane whose thickness rises with u, read back through the BSDF and the layer.
class GreyByThickness final : public VaryingBsdf {
 public:
  const Bsdf& at(const Parameters& parameters, BsdfRoom& room) const override {
    const Rgb albedo(parameters.film_thickness_nm / 1000);
    if (parameters.base_ior == 2) return room.adopt(std::make_unique<Lambert>(albedo));
    return room.emplace<Lambert>(albedo);
  }
};

TEST(Render, VaryingParametersReachTheBsdf) {
  for (const double base_ior : {1, 2}) {
    Scene scene = scene_from(from_above(53.13010235415598, 8, 8) + R"(
spp = 16
max_bounces = 1
[environment]
color = 1
[[material]]
name = "m"
type = "skin"
film_thickness_nm = {from = 0, to = 1000, ramp = [1, 0]}
[[object]]
type = "plane"
half_size = 1
material = "m"
)");
    scene.materials[0].parameters[1] = ParameterField::of(base_ior);
    const GreyByThickness grey;
    const RenderResult result = render(scene, std::vector<SurfaceBsdf>{&grey}, {.first_hits = true});
    double low = 1, high = 0;
    for (int i = 0; i < 64; ++i) {
      const double value = result.mean.get(i % 8, i / 8).r;
      EXPECT_NEAR(result.first_hits->film_thickness_nm[static_cast<std::size_t>(i)], 1000 * value, 0.01);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    EXPECT_NEAR(low, 1.0 / 16, 0.02);  // u is 0 to 1 across the picture
    EXPECT_NEAR(high, 15.0 / 16, 0.02);
  }
}

TEST(Render, CameraInsideAnObjectIsRefusedUnlessWanted) {
  Scene scene = small_scene();
  scene.objects.push_back({Sphere{scene.camera.position, 0.1}, 0});
  const std::string message = error_of([&] { render_with(scene, Lambert(Rgb(0.5)), {}); });
  EXPECT_NE(message.find("inside object " + std::to_string(scene.objects.size())), std::string::npos)
      << message;
  scene.camera.inside = true;
  EXPECT_EQ(error_of([&] { render_with(scene, Lambert(Rgb(0.5)), {}); }), "");
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
  EXPECT_EQ(error_of([&] { render(scene, std::vector<SurfaceBsdf>{static_cast<const Bsdf*>(nullptr)}, {}); }),
            "render: material \"grey\" has no BSDF");
}

}  // namespace
}  // namespace sunbeam
