#include "runtime/tracer/sky.h"

#include "runtime/tracer/environment.h"
#include "sunbeam/core/color_space.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

constexpr double kDegree = kPi / 180;

Sky sky_with(double sun_theta_deg, double sun_phi_deg, double turbidity) {
  Sky sky;
  sky.sun_direction = 7 * spherical_direction(sun_theta_deg * kDegree, sun_phi_deg * kDegree);
  sky.turbidity = turbidity;
  return sky;
}

double y_of(const Rgb& color) { return luminance(color, ColorSpace::rec709); }

void expect_near(const Rgb& color, const Rgb& expected, double relative) {
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(color[channel], expected[channel], relative * max_component(expected)) << channel;
}

// The paper's formulas worked out apart, in another language. Luminance and chromaticity of the first are
// 7.3204, (0.2457, 0.2515).
TEST(Sky, RadianceFollowsTheFormula) {
  const Rgb zenith = sky_radiance(sky_with(45, 0, 3), {0, 0, 1});
  EXPECT_NEAR(y_of(zenith),
              (4.0453 * 3 - 4.9710) * std::tan((4.0 / 9 - 3.0 / 120) * kPi / 2) - 0.2155 * 3 + 2.4192, 1e-9);
  expect_near(zenith, {4.625398495, 7.409398078, 14.376166490}, 1e-6);
  // 60 degrees from the zenith and 90 from the sun; then 70 and 15.
  const auto at = [](double theta, double gamma, double sun_theta) {
    const double t = theta * kDegree, s = sun_theta * kDegree;
    const double cos_phi =
        (std::cos(gamma * kDegree) - std::cos(t) * std::cos(s)) / (std::sin(t) * std::sin(s));
    EXPECT_LE(std::abs(cos_phi), 1 + 1e-9);
    return spherical_direction(t, std::acos(std::clamp(cos_phi, -1.0, 1.0)));
  };
  expect_near(sky_radiance(sky_with(30, 0, 2.5), at(60, 90, 30)), {3.080835210, 5.890409639, 11.086219188},
              1e-6);
  expect_near(sky_radiance(sky_with(85, 0, 8), at(70, 15, 85)), {11.077921610, 6.507741985, 2.770615485},
              1e-6);
}

// Sums of 75 terms over the tables of the standard observer, not its fit, which is 1 to 2 % off.
TEST(Sky, SunlightFollowsTheFormula) {
  expect_near(sun_light(sky_with(0, 0, 2)).irradiance, {113.1932, 98.1254, 87.7183}, 0.02);
  expect_near(sun_light(sky_with(45, 0, 3)).irradiance, {93.8177, 77.1304, 62.3125}, 0.02);
  expect_near(sun_light(sky_with(80, 0, 6)).irradiance, {7.93147, 3.33530, 0.69303}, 0.02);
}

TEST(Sky, SunIsADiscOfHalfADegree) {
  const SunLight sun = sun_light(sky_with(60, 90, 3));
  EXPECT_NEAR(length(sun.direction - spherical_direction(60 * kDegree, 90 * kDegree)), 0, 1e-12);
  EXPECT_DOUBLE_EQ(2 * sun.angular_radius, 0.53 * kDegree);
  expect_near(sun.irradiance, kPi * square(0.265 * kDegree) * sun.radiance, 1e-5);  // small angles
}

TEST(Sky, SunReddensAndFadesTowardsTheHorizonAndInHaze) {
  Rgb higher(1e9);  // white
  for (const double theta : {0.0, 50.0, 70.0, 80.0, 85.0, 88.0, 90.0}) {
    const Rgb sun = sun_light(sky_with(theta, 0, 3)).irradiance;
    EXPECT_LT(y_of(sun), y_of(higher));
    if (theta <= 85) {  // lower, no blue is left in Rec.709
      EXPECT_LT(sun.b / sun.r, higher.b / higher.r);
    }
    EXPECT_LT(y_of(sun_light(sky_with(theta, 0, 8)).irradiance), y_of(sun));
    higher = sun;
  }
}

TEST(Sky, MapHoldsTheRadianceAtTexelCentres) {
  const Sky sky = sky_with(40, 120, 4);
  EnvironmentSource source{{}, sky_map(sky, 64, 32)};
  const Environment environment(source);
  // Centres of the texels by rows and columns: column 16 begins at +y (90 degrees), columns run clockwise.
  for (const int row : {0, 7, 15})
    for (const int column : {0, 16, 40, 63}) {
      const Vec3 w =
          spherical_direction((row + 0.5) / 32 * kPi, 90 * kDegree - (column + 0.5 - 16) / 64 * 2 * kPi);
      const Rgb expected = sky_radiance(sky, w);
      EXPECT_LT(max_component(environment.radiance(w) - expected), 1e-6 * max_component(expected));
      EXPECT_LT(max_component(expected - environment.radiance(w)), 1e-6 * max_component(expected));
    }
}

// The sun stands in the middle of column 30 (an azimuth of 180 - (30 + 0.5) 360 / 90 degrees).
TEST(Sky, IsMirroredAtTheMeridianOfTheSun) {
  const Image map = sky_map(sky_with(55, 180 - 30.5 * 4, 3), 90, 45);
  for (int y = 0; y < 45; ++y)
    for (int k = 1; k < 45; ++k) expect_near(map.get((30 + k) % 90, y), map.get((30 - k + 90) % 90, y), 1e-6);
}

TEST(Sky, EveryAllowedSkyIsFiniteNonNegativeAndBrightestAroundTheSun) {
  for (const double turbidity : {2.0, 3.0, 6.0, 10.0})
    for (const double theta : {0.0, 30.0, 60.0, 85.0, 90.0}) {
      const Sky sky = sky_with(theta, 33, turbidity);
      const Image map = sky_map(sky, 120, 61);  // an odd height: one row lies on the horizon
      double brightest = 0;
      Vec3 where;
      for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
          const Rgb color = map.get(x, y);
          ASSERT_TRUE(is_finite(color));
          ASSERT_GE(std::min({color.r, color.g, color.b}), 0);
          ASSERT_EQ(y_of(color) > 0, y <= map.height / 2) << turbidity << " " << theta << " row " << y;
          if (y_of(color) <= brightest) continue;
          brightest = y_of(color);
          where = spherical_direction(kPi * (y + 0.5) / map.height, kPi * (1 - 2 * (x + 0.5) / map.width));
        }
      if (turbidity == 2) continue;  // here the model makes the horizon brighter than all above
      EXPECT_GT(dot(where, normalize(sky.sun_direction)), std::cos(12 * kDegree))
          << turbidity << " " << theta;
    }
}

// A black ground, and one of which every texel sends back what falls on it: the irradiance from the upper
// half by a sum of its own, and the sun.
TEST(Sky, GroundReflectsSkyAndSun) {
  Sky sky = sky_with(50, 10, 3);
  EXPECT_TRUE(is_black(sky_map(sky, 16, 8).get(3, 6)));
  sky.ground_albedo = {0.2, 0.5, 1};
  const Image map = sky_map(sky, 400, 200);
  Rgb irradiance = sun_light(sky).irradiance * std::cos(50 * kDegree);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 400; ++x) {
      const double theta = kPi * (y + 0.5) / 200;
      irradiance += map.get(x, y) * (std::cos(theta) * std::sin(theta) * (kPi / 200) * (2 * kPi / 400));
    }
  expect_near(map.get(0, 100), sky.ground_albedo * irradiance * kInvPi, 1e-3);
  EXPECT_EQ(map.get(399, 199), map.get(0, 100));
}

TEST(Sky, ScalesAsAWhole) {
  Sky sky = sky_with(50, 10, 3);
  sky.ground_albedo = Rgb(0.3);
  const Image map = sky_map(sky, 8, 4);
  const SunLight sun = sun_light(sky);
  sky.scale = 0.5;
  const Image half = sky_map(sky, 8, 4);
  for (std::size_t k = 0; k < map.rgb.size(); ++k) EXPECT_FLOAT_EQ(half.rgb[k], map.rgb[k] / 2);
  expect_near(sun_light(sky).radiance, sun.radiance * 0.5, 1e-12);
}

TEST(Sky, RefusesWhatTheModelDoesNotCover) {
  const auto expect_refusal = [](const auto& change, const std::string& found) {
    Sky sky;
    change(sky);
    for (const std::string& message :
         {error_of([&] { sky_map(sky, 4, 2); }), error_of([&] { sun_light(sky); }), error_of([&] {
            sky_radiance(sky, {0, 0, 1});
          })})
      EXPECT_NE(message.find(found), std::string::npos) << message;
  };
  const double nan = std::nan("");
  expect_refusal([](Sky& s) { s.turbidity = 1.9; }, "turbidity 1.9; allowed: 2 to 10");
  expect_refusal([](Sky& s) { s.turbidity = 10.1; }, "turbidity 10.1");
  expect_refusal([&](Sky& s) { s.turbidity = nan; }, "turbidity nan");
  expect_refusal([](Sky& s) { s.sun_direction = {1, 0, -0.1}; }, "[1, 0, -0.1]; allowed: z from 0");
  expect_refusal([](Sky& s) { s.sun_direction = {}; }, "[0, 0, 0]");
  expect_refusal([&](Sky& s) { s.sun_direction = {nan, 0, 1}; }, "[nan, 0, 1]");
  expect_refusal([](Sky& s) { s.ground_albedo.g = 1.5; }, "albedo 1.5; allowed: 0 to 1");
  expect_refusal([](Sky& s) { s.scale = 0; }, "scale 0; allowed: above 0");
  expect_refusal([&](Sky& s) { s.scale = nan; }, "scale nan");
}

}  // namespace
}  // namespace sunbeam
