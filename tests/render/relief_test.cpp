// Bump mapping: the turned normal, and that its corrections neither leak, nor darken, nor add light.
#include "runtime/tracer/relief.h"

#include <gtest/gtest.h>

#include <numbers>

#include "runtime/tracer/scales.h"
#include "sunbeam/core/frame.h"
#include "tests/render/support.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

HeightMap scales() { return scale_height_map({.columns = 4, .rows = 4, .jitter = 1}, 0.4, 24); }

Relief relief_of(const HeightMap& map, const Point2& tiles, double height) {
  return {std::make_shared<HeightMap>(map), tiles, height};
}

Vec3 random_direction(Rng& rng) { return sample_sphere({rng.uniform(), rng.uniform()}); }

// --- the normal ---

TEST(Relief, NormalIsThatOfTheDisplacedPlane) {
  // Sheared and stretched coordinates, right-handed or mirrored; the oracle is the displaced surface itself.
  for (const double mirror : {1.0, -1.0}) {
    const UvDerivatives derivatives = {{1.5, 0.2, 0}, mirror * Vec3{0.7, 2.5, 0}};
    const Relief relief = relief_of(scales(), {3, 2}, 0.02);
    const double height = relief.height * length(derivatives.du);
    const auto displaced = [&](double u, double v) {
      const double h = height * relief.map->sample({3 * u, 2 * v}).height;
      return u * derivatives.du + v * derivatives.dv + Vec3{0, 0, h};
    };
    constexpr double kStep = 1e-6;
    Rng rng(1, 0);
    for (int i = 0; i < 200; ++i) {
      const double u = rng.uniform(), v = rng.uniform();
      const Vec3 expected = mirror * normalize(cross(displaced(u + kStep, v) - displaced(u - kStep, v),
                                                     displaced(u, v + kStep) - displaced(u, v - kStep)));
      const Vec3 found = relief_normal(relief, {u, v}, {0, 0, 1}, derivatives);
      ASSERT_LT(length(found - expected), 1e-6);
    }
  }
}

TEST(Relief, TheHeadHasAMapOfItsOwn) {
  const UvDerivatives derivatives = {{1.5, 0, 0}, {0, 1.5, 0}};
  Relief relief = relief_of(scales(), {3, 2}, 0.02);
  const Relief body = relief, head = relief_of(scale_height_map({}, 0.4, 24), {1, 1}, 0.02);
  relief.head = head.map;
  const Vec3 up = {0, 0, 1};
  for (const double v : {-2.3, -0.1, 0.0, 0.3, 0.9}) {
    const Vec3 found = relief_normal(relief, {0.2, v}, up, derivatives);
    EXPECT_EQ(length(found - relief_normal(v < 0 ? body : head, {0.2, v}, up, derivatives)), 0) << v;
  }
  EXPECT_GT(length(relief_normal(body, {0.2, 0.3}, up, derivatives) -
                   relief_normal(head, {0.2, 0.3}, up, derivatives)),
            0.001);
}

TEST(Relief, FlatOrUnknownCoordinatesLeaveTheNormal) {
  const Vec3 normal = normalize(Vec3{1, 2, 3});
  const Relief relief = relief_of(scales(), {3, 2}, 0.1);
  for (const UvDerivatives& derivatives :
       {UvDerivatives{}, UvDerivatives{{1, 0, 0}, {2, 0, 0}}, UvDerivatives{{1, 0, 0}, {}}})
    EXPECT_EQ(length(relief_normal(relief, {0.3, 0.4}, normal, derivatives) - normal), 0);
  const Relief level = relief_of({1, 1, {7.0f}}, {3, 2}, 0.1);
  const Frame frame = Frame::from_normal(normal);
  EXPECT_LT(length(relief_normal(level, {0.3, 0.4}, normal, {frame.tangent, frame.bitangent}) - normal),
            1e-15);
}

TEST(Relief, ValidNormalReflectsAboveTheSurface) {
  Rng rng(2, 0);
  int turned = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 geometric = random_direction(rng), normal = random_direction(rng);
    const double grazing = std::pow(10.0, -6 * rng.uniform());
    const Vec3 wo =
        Frame::from_normal(geometric).to_world(direction_from_cosine(grazing, 2 * kPi * rng.uniform()));
    const Vec3 valid = valid_normal(normal, geometric, wo);
    const double above = dot(wo, geometric), least = std::min(0.9 * above, 0.01);
    const double reflected = dot(reflect(wo, valid), geometric);
    ASSERT_NEAR(length(valid), 1, 1e-9);
    ASSERT_GT(dot(valid, wo), 0);
    ASSERT_GE(reflected, least - 1e-9);
    ASSERT_GT(reflected, 0);
    if (length(valid - normal) == 0) continue;
    ++turned;
    // No farther than needed, within the plane of the two normals.
    ASSERT_LT(reflected, least + 1e-6);
    ASSERT_NEAR(dot(valid, normalize(cross(geometric, normal))), 0, 1e-6);
  }
  EXPECT_GT(turned, 1000);
  EXPECT_LT(turned, 19000);
}

TEST(Relief, TerminatorShadowingIsContinuousAndBounded) {
  const Vec3 smooth = {0, 0, 1};
  Rng rng(3, 0);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 normal = direction_from_cosine(0.2 + 0.8 * rng.uniform(), 2 * kPi * rng.uniform());
    const Vec3 wi = random_direction(rng);
    const double s = terminator_shadowing(normal, smooth, wi);
    ASSERT_TRUE(s >= 0 && s <= 1);
    if (wi.z <= 0) {
      ASSERT_EQ(s, 0);
    }
    // Half way between the terms of its definition.
    const double g = wi.z / (dot(normal, wi) * normal.z);
    if (wi.z > 0 && dot(normal, wi) > 0) {
      ASSERT_NEAR(s, g >= 1 ? 1 : g + g * g - g * g * g, 1e-12);
    }
    // At the horizon of the smooth surface it starts from 0.
    const Vec3 horizon = normalize(Vec3{normal.x, normal.y, 1e-4});
    if (normal.z < 0.95) {
      ASSERT_LT(terminator_shadowing(normal, smooth, horizon), 0.01);
    }
  }
  EXPECT_EQ(terminator_shadowing(smooth, smooth, normalize(Vec3{1, 0, 0.01})), 1);
}

// --- pictures ---

const std::string kSphere = R"(
  [camera]
  position = [0, -4, 0]
  look_at = [0, 0, 0]
  fov_deg = 25
  [render]
  width = 24
  height = 24
  spp = 64
  [[material]]
  name = "a"
  type = "diffuse"
  scales = { around = 12, height = 0.5, edge = 0.3, pattern = "voronoi" }
  [[object]]
  type = "sphere"
  radius = 1
  material = "a"
)";
const std::string kSky = "[environment]\ncolor = 1\n";

// The mean of the picture, no pixel of which may gain light.
double white_furnace(const std::string& text) {
  const RenderResult result = render_with(scene_from(text), Lambert(Rgb(1)), {.seed = 4});
  EXPECT_EQ(result.stats.bad_samples, 0u);
  double sum = 0;
  for (std::size_t i = 0; i < result.mean.rgb.size(); ++i) {
    // A false alarm, were the truth 1, in 50 million pixels.
    EXPECT_LE(result.mean.rgb[i], 1 + 5.5 * std::sqrt(result.variance.rgb[i]) + 1e-6);
    EXPECT_GE(result.mean.rgb[i], 0);
    sum += result.mean.rgb[i];
  }
  return sum / static_cast<double>(result.mean.rgb.size());
}

TEST(Relief, WhiteSphereUnderAWhiteSkyGainsNothing) {
  for (const std::string object : {"", "resolution = 64\n"}) {
    const std::string text = kSphere + object + kSky;
    EXPECT_LT(white_furnace(text), 1);
    std::string usual = text;
    usual.replace(usual.find("height = 0.5, edge = 0.3"), 24, "height = 0.12");
    const double mean = white_furnace(usual);
    EXPECT_LT(mean, 1);
    EXPECT_GT(mean, 0.87);  // measured: 0.888
  }
}

TEST(Relief, BsdfSamplesAloneNeverExceedOne) {
  const Scene scene = scene_from(kSphere + kSky);
  const RenderResult result = render_with(scene, LambertWithMisPdf(1, 1e9), {.seed = 5});
  for (const float value : result.mean.rgb) ASSERT_LE(value, 1 + 1e-6);
}

TEST(Relief, LightAndBsdfSamplesAgree) {
  // The two techniques weigh the same integrand: means within 4.5 standard errors (a false alarm in 150000
  // runs).
  Scene scene = scene_from(kSphere + kSky + R"(
    [[light]]
    type = "quad"
    center = [2, -2, 2]
    edge_u = [1, 1, 0]
    edge_v = [1, -1, 1]
    radiance = 5
  )");
  const auto estimate = [&](const Bsdf& bsdf) {
    return grey_estimate(render_with(scene, bsdf, {.spp = 256, .seed = 6}));
  };
  const Estimate by_light = estimate(LambertWithMisPdf(0.8, 1e-9)),
                 by_bsdf = estimate(LambertWithMisPdf(0.8, 1e9)), both = estimate(Lambert(Rgb(0.8)));
  const auto expect_agreement = [](const Estimate& a, const Estimate& b) {
    EXPECT_LT(std::abs(a.mean - b.mean), 4.5 * std::hypot(a.standard_error, b.standard_error));
    EXPECT_LT(std::hypot(a.standard_error, b.standard_error), 0.01 * a.mean);
  };
  expect_agreement(by_light, by_bsdf);
  expect_agreement(both, by_bsdf);
}

TEST(Relief, AMirrorNeverLosesItsReflection) {
  // The mirror image of the view lies above the surface, so only terminator_shadowing() takes light, never
  // all.
  Scene scene = scene_from(kSphere + kSky);
  scene.render.max_bounces = 1;
  const RenderResult result = render_with(scene, Mirror(1), {.width = 64, .height = 64, .spp = 1});
  EXPECT_EQ(result.stats.rays, 64u * 64u + result.stats.vertices);  // each hit sends one on
  int black = 0;
  for (const float value : result.mean.rgb) {
    ASSERT_LE(value, 1);
    black += value == 0;
  }
  EXPECT_EQ(black, 0);
}

TEST(Relief, TurnsTheNormalOnBothSidesAndOnMeshesAlike) {
  // The exact sphere and a fine mesh of it, same coordinates, one light: the same picture but for the
  // tessellation.
  const std::string light = "[[light]]\ntype = 'point'\nposition = [3, -4, 3]\nintensity = 60\n";
  const auto picture = [&](const std::string& object) {
    const Scene scene = scene_from(kSphere + object + light);
    return render_with(scene, Lambert(Rgb(1)), {.spp = 64, .seed = 7}).mean;
  };
  const Image exact = picture(""), mesh = picture("resolution = 512\n");
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < exact.rgb.size(); ++i) {
    difference += std::abs(exact.rgb[i] - mesh.rgb[i]);
    sum += exact.rgb[i];
  }
  EXPECT_LT(difference, 0.01 * sum);
}

}  // namespace
}  // namespace sunbeam
