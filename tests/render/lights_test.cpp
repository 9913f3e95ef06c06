// Sources of light: which one is chosen, and densities of samples. Seeds are fixed.
#include "runtime/tracer/lights.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/render/support.h"

namespace sunbeam {
namespace {

Image even_map(float radiance) {
  Image map(64, 32);
  for (float& value : map.rgb) value = radiance;
  return map;
}

// Two of every kind but the map, of unlike power. Only the second sun has a size; it is brighter than the
// map.
Scene every_light() {
  Scene scene;
  scene.quad_lights.push_back({{-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, Rgb(3)});
  scene.quad_lights.push_back({{-31, -1, 20}, {0, 2, 0}, {2, 0, 0}, Rgb(4)});
  scene.sphere_lights.push_back({{3, 0, 1}, 0.5, Rgb(20)});
  scene.sphere_lights.push_back({{0, 3, 1}, 0.5, Rgb(2)});
  scene.point_lights.push_back({{0, 0, 5}, Rgb(1)});
  scene.point_lights.push_back({{0, 0, 6}, Rgb(70)});
  scene.directional_lights.push_back({normalize(Vec3{0, 1, 1}), Rgb(3), 0});
  scene.directional_lights.push_back({normalize(Vec3{0, -1, 1}), Rgb(1), 10});
  scene.environment.map = even_map(0.5);
  return scene;
}
constexpr std::size_t kSources = 9;

// In front of and behind the quads, far off, in the middle of a sphere and on a point light.
const std::vector<Vec3> kReceivers = {{0.2, 0.1, 0}, {0.2, 0.1, 9}, {-30, 0, 3}, {1e7, -1e7, 0},
                                      {3, 0, 1},     {0, 0, 5},     {0, 0, 6}};

TEST(LightChoice, ChancesSumToOneAndNoneIsTooSmall) {
  const Scene scene = every_light();
  const Environment environment(scene.environment);
  const LightChoice choice(scene, environment);
  ASSERT_EQ(choice.size(), kSources);
  for (const Vec3& from : kReceivers) {
    double sum = 0;
    for (std::size_t i = 0; i < kSources; ++i) {
      sum += choice.chance(i, from);
      EXPECT_GE(choice.chance(i, from), 0.1 / kSources - 1e-12) << "source " << i;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(LightChoice, ChoosesWithItsChances) {
  const Scene scene = every_light();
  const Environment environment(scene.environment);
  const LightChoice choice(scene, environment);
  constexpr int kCount = 10000;
  for (const Vec3& from : kReceivers) {
    std::vector<double> found(kSources);
    for (int k = 0; k < kCount; ++k) {
      const auto [source, chance] = choice.choose(from, (k + 0.5) / kCount);
      ASSERT_LT(source, kSources);
      ASSERT_EQ(chance, choice.chance(source, from));
      found[source] += 1.0 / kCount;
    }
    // Both ends of a source's part of [0, 1) are met within half a step.
    for (std::size_t i = 0; i < kSources; ++i)
      EXPECT_NEAR(found[i], choice.chance(i, from), 1.01 / kCount) << "source " << i;
    EXPECT_LT(choice.choose(from, 1 - 0x1p-32).source, kSources);
  }
}

TEST(LightChoice, NineTenthsFollowTheIrradiance) {
  Scene scene;
  scene.quad_lights.push_back({{-0.1, -0.1, 10}, {0, 0.2, 0}, {0.2, 0, 0}, Rgb(5000)});   // faces down
  scene.quad_lights.push_back({{-0.1, -0.1, -10}, {0, 0.2, 0}, {0.2, 0, 0}, Rgb(5000)});  // away from below
  scene.sphere_lights.push_back({{6, 0, 8}, 0.1, Rgb(1000, 2000, 3000)});
  scene.point_lights.push_back({{0, 3, 4}, Rgb(25)});
  scene.directional_lights.push_back({{0, 0, 1}, Rgb(3), 0.5});
  scene.environment.map = even_map(0.25);
  const std::vector<double> irradiance = {5000 * 0.04 / 100, 0, 2000 * kPi * 0.01 / 100,
                                          25 / 25.0,         3, kPi * 0.25};
  const double total = std::accumulate(irradiance.begin(), irradiance.end(), 0.0);
  const Environment environment(scene.environment);
  const LightChoice choice(scene, environment);
  for (std::size_t i = 0; i < irradiance.size(); ++i)
    EXPECT_NEAR(choice.chance(i, {}), 0.1 / 6 + 0.9 * irradiance[i] / total, 1e-3) << "source " << i;
}

TEST(LightChoice, IsEvenWhereNothingShines) {
  Scene scene;
  scene.quad_lights.push_back({{-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, Rgb(3)});
  scene.quad_lights.push_back({{-1, -1, 3}, {0, 2, 0}, {2, 0, 0}, Rgb(5)});
  const Environment environment(scene.environment);
  const LightChoice choice(scene, environment);
  EXPECT_EQ(choice.chance(0, {0, 0, 9}), 0.5);
  EXPECT_EQ(choice.chance(1, {0, 0, 9}), 0.5);
}

// What a ray along the sample would see, by the density that it reports.
std::vector<Emission> found_again(const Lights& lights, const LightSample& sample, const Vec3& from,
                                  std::size_t source) {
  if (source < 4) return {lights.surface(static_cast<int>(source), from, sample.wi, sample.distance)};
  std::vector<Emission> seen;
  lights.for_each_far_off(from, sample.wi, [&](const Emission& emission) { seen.push_back(emission); });
  return seen;
}

TEST(Lights, DensityOfASampleIsTheDensityAFoundRayWouldReport) {
  const Scene scene = every_light();
  const Lights lights(scene);
  const Environment environment(scene.environment);
  const LightChoice choice(scene, environment);
  const Vec3 sun = scene.directional_lights[1].towards;
  for (const Vec3& from : {Vec3{0.2, 0.1, 0}, Vec3{-0.5, 0.4, 1}}) {
    Rng rng(3, 4);
    constexpr int kCount = 5000;
    std::vector<double> seen(kSources);
    for (int i = 0; i < kCount; ++i) {
      const Random3 u = random3(rng);
      const std::size_t source = choice.choose(from, u[0]).source;
      const auto sample = lights.sample(from, u);
      ASSERT_TRUE(sample);
      ++seen[source];
      EXPECT_EQ(sample->is_dirac, source == 4 || source == 5 || source == 6);
      EXPECT_EQ(std::isinf(sample->distance), source >= 6);
      if (sample->is_dirac) {
        EXPECT_EQ(sample->pdf, choice.chance(source, from));
        continue;
      }
      const std::vector<Emission> found = found_again(lights, *sample, from, source);
      const Emission& emission = source == 7 ? found.back() : found.front();
      EXPECT_DOUBLE_EQ(sample->pdf, emission.pdf) << "source " << source;
      EXPECT_EQ(sample->radiance, emission.radiance) << "source " << source;
      if (source == 7) {
        EXPECT_GT(dot(sample->wi, sun), std::cos(5.001 * kPi / 180));
      }
    }
    // 5.5 standard deviations: false alarm 18 * 4e-8.
    for (std::size_t k = 0; k < kSources; ++k) {
      const double chance = choice.chance(k, from);
      EXPECT_NEAR(seen[k], kCount * chance, 5.5 * std::sqrt(kCount * chance * (1 - chance)))
          << "source " << k;
    }
  }
}

TEST(Lights, ASingleSourceIsChosenForSure) {
  Scene scene;
  scene.point_lights.push_back({{0, 0, 5}, Rgb(2)});
  const Lights point(scene);
  const auto sample = point.sample({}, {0.3, 0.2, 0.7});
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->pdf, 1);

  scene.point_lights.clear();
  scene.quad_lights.push_back({{-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, Rgb(3)});
  EXPECT_EQ(Lights(scene).surface(0, {}, {0, 0, 1}, 2).pdf, 1.0);  // d^2 / A = 4 / 4
}

TEST(Lights, OneBrightAmongManyDimOnesMakesLittleNoise) {
  // Straight below ten point lights. Their choice is all there is of noise: of x_i / p_i, drawn with chance
  // p_i, the variance is sum x_i^2 / p_i - (sum x_i)^2.
  std::string lights;
  std::vector<double> radiance;
  for (int i = 0; i < 10; ++i) {
    const double intensity = i == 7 ? 50 : 0.1 * (1 + i);
    lights += "[[light]]\ntype = 'point'\nposition = [0, 0, " + std::to_string(i + 1) +
              "]\nintensity = " + std::to_string(intensity) + "\n";
    radiance.push_back(0.5 * kInvPi * intensity / square(i + 1.0));
  }
  const double sum = std::accumulate(radiance.begin(), radiance.end(), 0.0);
  double variance = -square(sum), even_variance = -square(sum);
  for (const double x : radiance) {
    variance += square(x) / (0.01 + 0.9 * x / sum);
    even_variance += square(x) / 0.1;
  }
  const Estimate found =
      grey_estimate(render_with(scene_from(kPlane + lights), Lambert(Rgb(0.5)), {.spp = 1000}));
  EXPECT_NEAR(found.mean, sum, 5 * found.standard_error + 1e-5);  // false alarm 6e-7
  // 16,000 samples; the dimmest lights are drawn with a chance of 0.01, and 160 of 0.08 in standard
  // deviation.
  EXPECT_NEAR(square(found.standard_error) * 16000 / variance, 1, 0.4);
  EXPECT_LT(variance, 0.05 * even_variance);
}

TEST(Lights, SamplesOfASphereLieOnItsNearSide) {
  Scene scene;
  scene.sphere_lights.push_back({{3, 1, 2}, 0.5, Rgb(2)});
  const Lights lights(scene);
  Rng rng(5, 6);
  for (int i = 0; i < 1000; ++i) {
    const auto sample = lights.sample({0.2, 0.1, 0}, random3(rng));
    ASSERT_TRUE(sample);
    const Vec3 point = Vec3{0.2, 0.1, 0} + sample->distance * sample->wi;
    const Vec3 normal = 2 * (point - scene.sphere_lights[0].center);
    EXPECT_NEAR(length(normal), 1, 1e-9);
    EXPECT_LE(dot(normal, sample->wi), 1e-7);
  }
  EXPECT_FALSE(lights.sample({3, 1, 2.1}, random3(rng)));  // no light inside
}

}  // namespace
}  // namespace sunbeam
