// Light transport against known answers. All seeds are fixed; the false-alarm rates are those of a fresh
// seed.
#include <gtest/gtest.h>

#include "runtime/tracer/environment.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

// 2 x 2 at height 1, radiance 2, facing down.
const std::string kQuadLight = R"(
[[light]]
type = "quad"
center = [0, 0, 1]
edge_u = [0, 2, 0]
edge_v = [2, 0, 0]
radiance = 2
)";

// Configuration factor from a point to a parallel rectangle with half sides a = b = h = 1 over it (Howell
// B-4, four corners): 4 / (2 pi) * 2 * (1 / sqrt(2)) * atan(1 / sqrt(2)). Radiance out = albedo * radiance *
// factor.
double quad_radiance() {
  return 0.5 * 2 * (4 * kInvPi) * std::numbers::sqrt2 / 2 * std::atan(std::numbers::sqrt2 / 2);
}

TEST(Transport, ConvexAndConcaveWhiteFurnaceIsExactlyOne) {
  // Two touching spheres of albedo 1 in constant radiance 1: each path leaves with throughput 1, whatever its
  // length, so there is no noise. One lost or doubled bounce shows.
  const Scene scene = scene_from(R"(
    [camera]
    position = [0, -6, 0]
    look_at = [0, 0, 0]
    [render]
    width = 32
    height = 24
    spp = 16
    max_bounces = 10000
    [environment]
    color = 1
    [[material]]
    name = "white"
    type = "diffuse"
    albedo = 1
    [[object]]
    type = "sphere"
    center = [-1, 0, 0]
    radius = 1
    material = "white"
    [[object]]
    type = "sphere"
    center = [1, 0, 0]
    radius = 1
    material = "white"
  )");
  const RenderResult result = render_with(scene, Lambert(Rgb(1)), {});
  EXPECT_GT(result.stats.vertices, result.stats.samples / 8);  // the spheres are in the picture
  for (const float value : result.mean.rgb) ASSERT_NEAR(value, 1, 1e-6);
}

TEST(Transport, WhiteFurnaceByImportanceSampledMapIsOneWithinNoise) {
  Scene scene = scene_from(R"(
    [camera]
    position = [0, -6, 0]
    look_at = [0, 0, 0]
    fov_deg = 14
    [[material]]
    name = "white"
    type = "diffuse"
    albedo = 1
    [[object]]
    type = "sphere"
    center = [0, 0, 0]
    radius = 1
    material = "white"
  )");
  scene.environment.map = Image(16, 8);
  for (float& value : scene.environment.map.rgb) value = 1;
  const RenderResult result = render_with(scene, Lambert(Rgb(1)), {.width = 16, .height = 16, .spp = 256});
  // 256 pixels at 6 standard errors of 256 samples each: false alarm below 1e-6 (Student, 255 degrees).
  for (std::size_t i = 0; i < result.mean.rgb.size(); ++i)
    ASSERT_NEAR(result.mean.rgb[i], 1, 6 * std::sqrt(result.variance.rgb[i]) + 1e-6) << "value " << i;
  EXPECT_LT(grey_estimate(result).standard_error, 0.005);  // so the bound above can fail
}

TEST(Transport, QuadLightMatchesTheConfigurationFactorWhateverTheMisWeights) {
  const Scene scene = scene_from(kPlane + kQuadLight);
  for (const double mis_pdf : {1e-20, 0.2, 1e20}) {
    const Estimate estimate =
        grey_estimate(render_with(scene, LambertWithMisPdf(0.5, mis_pdf), {.spp = 4000}));
    // 5 standard errors: false alarm 6e-7 each. Pixel size moves the mean by less than 1e-5.
    EXPECT_NEAR(estimate.mean, quad_radiance(), 5 * estimate.standard_error + 1e-5) << "mis_pdf " << mis_pdf;
    EXPECT_LT(estimate.standard_error, 0.005) << "mis_pdf " << mis_pdf;
  }
}

TEST(Transport, MisOfTheBsdfItselfAgreesAndIsLessNoisyThanBsdfSampling) {
  const Scene scene = scene_from(kPlane + kQuadLight);
  const Estimate mis = grey_estimate(render_with(scene, Lambert(Rgb(0.5)), {.spp = 4000}));
  const Estimate bsdf_only = grey_estimate(render_with(scene, LambertWithMisPdf(0.5, 1e20), {.spp = 4000}));
  // 5 standard errors of the difference: false alarm 6e-7.
  EXPECT_NEAR(mis.mean, bsdf_only.mean, 5 * std::hypot(mis.standard_error, bsdf_only.standard_error));
  EXPECT_LT(mis.standard_error, 0.7 * bsdf_only.standard_error);
}

TEST(Transport, PointLightFallsOffWithTheInverseSquare) {
  // Straight above: irradiance I / d^2 = 8 / 4 = 2 at d = 2, 0.5 at d = 4; radiance = 0.5 / pi * irradiance.
  const auto radiance_at = [](const std::string& position) {
    const Scene scene =
        scene_from(kPlane + "[[light]]\ntype = 'point'\nintensity = 8\nposition = " + position);
    return grey_estimate(render_with(scene, Lambert(Rgb(0.5)), {.spp = 4})).mean;
  };
  EXPECT_NEAR(radiance_at("[0, 0, 2]"), kInvPi, 1e-5);
  EXPECT_NEAR(radiance_at("[0, 0, 4]"), kInvPi / 4, 1e-5);
  // At 60 degrees, d = 2: half the cosine.
  EXPECT_NEAR(radiance_at("[0, 1.7320508, 1]"), kInvPi / 2, 1e-3 * kInvPi);
}

// Any technique alone, and MIS of both, give the closed form.
void expect_radiance(const std::string& light, double expected) {
  const Scene scene = scene_from(kPlane + light);
  for (const double mis_pdf : {1e-20, 0.3, 1e20}) {
    const Estimate estimate =
        grey_estimate(render_with(scene, LambertWithMisPdf(0.5, mis_pdf), {.spp = 20000}));
    EXPECT_NEAR(estimate.mean, expected, 5 * estimate.standard_error + 1e-5) << light << mis_pdf;  // 6e-7
    EXPECT_LT(estimate.standard_error, 0.02 * expected) << light << mis_pdf;
  }
}

TEST(Transport, SphereLightMatchesItsConfigurationFactor) {
  // Fully above the horizon: irradiance pi L (R / d)^2 cos. Here R / d = 0.5, cos = 0.8.
  expect_radiance("[[light]]\ntype = 'sphere'\nradiance = 3\nradius = 1\ncenter = [-1.2, 0, 1.6]\n",
                  0.5 * 3 * 0.25 * 0.8);
}

TEST(Transport, DirectionalLightGivesItsIrradianceWhateverItsSize) {
  // Irradiance 5 at normal incidence, at 60 degrees: exact for a disc, too, while all of it is above.
  expect_radiance(
      "[[light]]\ntype = 'directional'\nirradiance = 5\nangle_deg = 30\ntowards = [0, 1.7320508, 1]\n",
      0.5 * kInvPi * 5 * 0.5);
  const Scene point =
      scene_from(kPlane + "[[light]]\ntype = 'directional'\nirradiance = 5\ntowards = [0, 1.7320508, 1]\n");
  EXPECT_NEAR(grey_estimate(render_with(point, Lambert(Rgb(0.5)), {.spp = 4})).mean, 0.5 * kInvPi * 5 * 0.5,
              1e-6);
}

TEST(Transport, LightsAddUp) {
  const Scene scene =
      scene_from(kPlane + kQuadLight + "[[light]]\ntype = 'point'\nintensity = 8\nposition = [0, -2, 0.5]\n");
  // The point light adds 0.5 / pi * 8 * cos / d^2 with d^2 = 4.25 and cos = 0.5 / d.
  const double expected = quad_radiance() + 0.5 * kInvPi * 8 * 0.5 / std::pow(4.25, 1.5);
  const Estimate estimate = grey_estimate(render_with(scene, Lambert(Rgb(0.5)), {.spp = 4000}));
  EXPECT_NEAR(estimate.mean, expected, 5 * estimate.standard_error + 1e-4);  // false alarm 6e-7
  EXPECT_LT(estimate.standard_error, 0.005);
}

TEST(Transport, UnlikeLightsAddUpWhateverTheMisWeights) {
  // Side by side: the quad, spheres of (R / d)^2 = 0.01 near by and far off at cos = 0.6, a sun at 60
  // degrees.
  expect_radiance(kQuadLight + R"(
                    [[light]]
                    type = "sphere"
                    radiance = 100
                    radius = 0.4
                    center = [-3.2, 0, 2.4]
                    [[light]]
                    type = "sphere"
                    radiance = 20
                    radius = 10
                    center = [0, 80, 60]
                    [[light]]
                    type = "directional"
                    irradiance = 5
                    angle_deg = 20
                    towards = [0, -1.7320508, 1]
                  )",
                  quad_radiance() + 0.5 * (100 + 20) * 0.01 * 0.6 + 0.5 * kInvPi * 5 * 0.5);
}

TEST(Transport, EnvironmentMapLightsThePlaneAsItsIntegralSays) {
  Scene scene = scene_from(kPlane);
  scene.environment.map = Image(32, 16);
  scene.environment.map.set(5, 2, Rgb(100));
  scene.environment.map.set(20, 12, Rgb(100));  // below the horizon: must not count
  // Irradiance of texel row 2 of 16: 100 * dphi * integral of sin cos over theta in [2, 3] pi / 16.
  const double irradiance =
      100 * (2 * kPi / 32) * 0.5 * (square(std::sin(3 * kPi / 16)) - square(std::sin(2 * kPi / 16)));
  for (const double mis_pdf : {1e-20, 0.3}) {
    const Estimate estimate =
        grey_estimate(render_with(scene, LambertWithMisPdf(0.5, mis_pdf), {.spp = 4000}));
    EXPECT_NEAR(estimate.mean, 0.5 * kInvPi * irradiance, 5 * estimate.standard_error) << mis_pdf;  // 6e-7
    EXPECT_LT(estimate.standard_error, 0.02 * estimate.mean) << mis_pdf;
  }
}

TEST(Transport, LightBelowTheGeometricSurfaceNeverArrives) {
  // A flat sheet whose vertex normals lean 60 degrees towards the camera, albedo 1, radiance 1 from
  // everywhere: of the cosine lobe about the normal, (1 + cos 60) / 2 = 0.75 lies above the sheet, and only
  // that may be seen.
  Scene scene = scene_from(kPlane);
  Mesh& sheet = std::get<Mesh>(scene.objects[0].shape);
  sheet.normals.assign(4, {std::sin(kPi / 3), 0, std::cos(kPi / 3)});
  scene.render.max_bounces = 8;
  for (const bool as_map : {false, true}) {
    scene.environment.color = Rgb(1);
    scene.environment.map = as_map ? Image(32, 16) : Image();
    for (float& value : scene.environment.map.rgb) value = 1;
    const Estimate estimate = grey_estimate(render_with(scene, Lambert(Rgb(1)), {.spp = 2000}));
    EXPECT_NEAR(estimate.mean, 0.75, 5 * estimate.standard_error) << as_map;  // false alarm 6e-7
    EXPECT_LT(estimate.standard_error, 0.01) << as_map;
  }
}

TEST(Transport, ASphereCastsABlackShadow) {
  const std::string light = "[[light]]\ntype = 'point'\nintensity = 8\nposition = [0, 0, 4]\n";
  const std::string sphere =
      "[[object]]\ntype = 'sphere'\ncenter = [0, 0, 3]\nradius = 0.1\nmaterial = 'grey'\n";
  EXPECT_NEAR(grey_estimate(render_with(scene_from(kPlane + light), Lambert(Rgb(0.5)), {.spp = 4})).mean,
              kInvPi / 4, 1e-5);
  EXPECT_EQ(
      grey_estimate(render_with(scene_from(kPlane + light + sphere), Lambert(Rgb(0.5)), {.spp = 4})).mean, 0);
}

TEST(Transport, QuadLightIsBlackAndOpaqueFromBehind) {
  // The same quad turned upwards: no light reaches the plane, and it hides the point light above it.
  std::string upwards = kQuadLight;
  upwards.replace(upwards.find("edge_u"), 6, "edge_X");
  upwards.replace(upwards.find("edge_v"), 6, "edge_u");
  upwards.replace(upwards.find("edge_X"), 6, "edge_v");
  const std::string point = "[[light]]\ntype = 'point'\nintensity = 8\nposition = [0, 0, 4]\n";
  const Scene scene = scene_from(kPlane + upwards + point);
  EXPECT_EQ(grey_estimate(render_with(scene, Lambert(Rgb(0.5)), {.spp = 256})).mean, 0);
}

TEST(Transport, CameraSeesTheFrontOfAQuadLightOnly) {
  const auto seen_from = [](const std::string& position) {
    const std::string camera =
        "[camera]\nup = [0, 1, 0]\nfov_deg = 1\nlook_at = [0, 0, 1]\nposition = " + position + "\n";
    const std::string rest = kPlane.substr(kPlane.find("[render]"));
    return grey_estimate(render_with(scene_from(camera + rest + kQuadLight), Lambert(Rgb(0.5)), {.spp = 4}))
        .mean;
  };
  EXPECT_FLOAT_EQ(static_cast<float>(seen_from("[0, 0, 0.5]")), 2);
  EXPECT_EQ(seen_from("[0, 0, 3]"), 0);
}

TEST(Transport, MirrorShowsTheEnvironmentInFull) {
  Scene scene = scene_from(kPlane);
  scene.environment.map = Image(8, 4);
  // The camera looks along (-4, 0, -2); the mirror sends that to (-4, 0, 2): azimuth 180 degrees is the left
  // and right border, height 26.6 degrees is row 1 of 4.
  scene.environment.map.set(0, 1, {1, 2, 3});
  scene.environment.map.set(7, 1, {1, 2, 3});
  const RenderResult result = render_with(scene, Mirror(0.8), {.spp = 8});
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_FLOAT_EQ(static_cast<float>(result.mean.get(x, y)[channel]),
                        static_cast<float>(0.8 * (channel + 1)));
}

TEST(Transport, MirrorShowsAQuadLightInFull) {
  // Seen in the plane at height -1 along (-4, 0, -2) from (4, 0, 2): the mirror image meets x = -2 at z = 1.
  std::string shifted = kQuadLight;
  shifted.replace(shifted.find("[0, 0, 1]"), 9, "[-2, 0, 1]");
  const RenderResult result = render_with(scene_from(kPlane + shifted), Mirror(0.8), {.spp = 8});
  for (const float value : result.mean.rgb) EXPECT_FLOAT_EQ(value, 1.6F);
}

TEST(Transport, BouncesAreCountedAndRussianRouletteKeepsTheMean) {
  // A point light in the middle of a closed sphere, seen from inside: every point of the wall gets the same
  // direct light D = a / pi * I / r^2 = 0.5, and each bounce adds a = 0.5 times what the one before it added.
  const auto wall_radiance = [](int max_bounces) {
    Scene scene = scene_from(R"(
      [camera]
      position = [0, -0.5, 0]
      look_at = [0, -1, 0]
      inside = true
      [[light]]
      type = "point"
      position = [0, 0, 0]
      intensity = 3.14159265358979
      [[material]]
      name = "wall"
      type = "diffuse"
      [[object]]
      type = "sphere"
      center = [0, 0, 0]
      radius = 1
      material = "wall"
    )");
    scene.render.max_bounces = max_bounces;
    return grey_estimate(render_with(scene, Lambert(Rgb(0.5)), {.width = 8, .height = 8, .spp = 500}));
  };
  EXPECT_NEAR(wall_radiance(1).mean, 0.5, 1e-5);
  EXPECT_NEAR(wall_radiance(2).mean, 0.75, 1e-5);
  const Estimate full = wall_radiance(200);
  EXPECT_NEAR(full.mean, 1, 5 * full.standard_error + 1e-5);  // false alarm 6e-7
  EXPECT_LT(full.standard_error, 0.01);
}

}  // namespace
}  // namespace sunbeam
