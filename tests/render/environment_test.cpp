// Lat-long maps: orientation, density and sampling. Seeds are fixed.
#include "runtime/tracer/environment.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/render/support.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

// Uneven, coloured, with a black row and black texels.
EnvironmentSource uneven_map() {
  EnvironmentSource source;
  source.map = Image(24, 12);
  Rng rng(7, 0);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 24; ++x)
      if (y != 3 && (x + y) % 5 != 0)
        source.map.set(x, y, {std::pow(rng.uniform(), 4), 2 * std::pow(rng.uniform(), 4), rng.uniform()});
  return source;
}

TEST(Environment, CentreIsPlusXLeftIsPlusYTopIsPlusZ) {
  EnvironmentSource source;
  source.map = Image(8, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) source.map.set(x, y, {static_cast<double>(x), static_cast<double>(y), 0});
  const Environment environment(source);
  const auto texel = [&](const Vec3& direction) { return environment.radiance(normalize(direction)); };
  EXPECT_EQ(texel({1, 0.01, 0.01}), Rgb(3, 1, 0));
  EXPECT_EQ(texel({1, -0.01, -0.01}), Rgb(4, 2, 0));
  EXPECT_EQ(texel({0.01, 1, 0.01}), Rgb(2, 1, 0));   // +y at a quarter from the left
  EXPECT_EQ(texel({0.01, -1, 0.01}), Rgb(5, 1, 0));  // -y at three quarters
  EXPECT_EQ(texel({0.01, 0.001, 1}).g, 0);
  EXPECT_EQ(texel({0.01, 0.001, -1}).g, 3);
}

TEST(Environment, PdfIntegratesToOne) {
  const EnvironmentSource source = uneven_map();
  const Environment environment(source);
  // pdf * sin(theta) is constant in a texel, so a midpoint rule on 4 x 4 points in each is exact.
  const int columns = 24 * 4, rows = 12 * 4;
  double integral = 0;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double theta = kPi * (j + 0.5) / rows, phi = 2 * kPi * (i + 0.5) / columns;
      integral += environment.pdf(spherical_direction(theta, phi)) * std::sin(theta) * (kPi / rows) *
                  (2 * kPi / columns);
    }
  EXPECT_NEAR(integral, 1, 1e-9);
}

TEST(Environment, SamplesFollowThePdfAndAgreeWithBruteForce) {
  const EnvironmentSource source = uneven_map();
  const Environment environment(source);
  const auto irradiance = [&](const Vec3& w) {
    return mean(environment.radiance(w)) * std::max(0.0, w.z + w.x);
  };
  Rng rng(1, 2);
  const int count = 200000;
  double sum[2] = {}, squares[2] = {};
  for (int i = 0; i < count; ++i) {
    const Vec3 important = environment.sample({rng.uniform(), rng.uniform()});
    const double density = environment.pdf(important);
    ASSERT_GT(density, 0);
    const Vec3 uniform = sample_sphere({rng.uniform(), rng.uniform()});
    const double value[2] = {irradiance(important) / density, irradiance(uniform) / sphere_pdf()};
    for (int k = 0; k < 2; ++k) sum[k] += value[k], squares[k] += square(value[k]);
  }
  double error[2];
  for (int k = 0; k < 2; ++k) error[k] = std::sqrt((squares[k] / count - square(sum[k] / count)) / count);
  // 5 standard errors: false alarm 6e-7.
  EXPECT_NEAR(sum[0] / count, sum[1] / count, 5 * std::hypot(error[0], error[1]));
  EXPECT_LT(error[0], error[1]);               // importance sampling pays
  EXPECT_LT(error[1], 0.01 * sum[1] / count);  // so the first bound can fail
}

TEST(Environment, EvenMapIsSampledEvenlyOverTheSphere) {
  EnvironmentSource source;
  source.map = Image(64, 64);
  for (float& value : source.map.rgb) value = 3;
  const Environment environment(source);
  // Exact at texel centres but for the normalisation, which is off by pi^2 / (24 * 64^2) = 1e-4.
  for (int y = 0; y < 64; ++y)
    EXPECT_NEAR(environment.pdf(spherical_direction(kPi * (y + 0.5) / 64, 1)) / sphere_pdf(), 1, 2e-4)
        << "row " << y;
}

TEST(Environment, MeanRadianceIsThatOfEvenDirections) {
  const EnvironmentSource source = uneven_map();
  const Environment environment(source);
  Rng rng(8, 0);
  const int count = 200000;
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const double value = mean(environment.radiance(sample_sphere({rng.uniform(), rng.uniform()})));
    sum += value;
    squares += square(value);
  }
  const double found = sum / count, error = std::sqrt((squares / count - square(found)) / count);
  // 5 standard errors: false alarm 6e-7. The sine at a row's centre is off by pi^2 / (24 * 12^2) = 0.3 %.
  EXPECT_NEAR(environment.mean_radiance(), found, 5 * error + 0.003 * found);
  EXPECT_LT(error, 0.005 * found);
}

// Sums of the largest floats pass the range of floats, and the smallest ones are denormal.
TEST(Environment, HugeAndTinyMapsAreSampledWithoutOverflow) {
  for (const float bright : {std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min()})
    for (const bool is_even : {false, true}) {
      EnvironmentSource source;
      source.map = Image(8, 4);
      for (float& value : source.map.rgb) value = is_even ? bright : 0;
      source.map.set(5, 2, Rgb(bright));
      const Environment environment(source);
      EXPECT_TRUE(std::isfinite(environment.mean_radiance()));
      EXPECT_GT(environment.mean_radiance(), 0);
      for (const double u : {0.01, 0.3, 0.7, 0.99}) {
        const Vec3 direction = environment.sample({u, u});
        EXPECT_NEAR(length(direction), 1, 1e-12);
        const double pdf = environment.pdf(direction);
        EXPECT_TRUE(std::isfinite(pdf) && pdf > 0) << pdf;
        EXPECT_NEAR(environment.radiance(direction).g / bright, 1, 1e-6);
      }
    }
}

TEST(Environment, ConstantIsNotSampled) {
  EnvironmentSource source;
  source.color = {1, 2, 3};
  const Environment environment(source);
  EXPECT_FALSE(environment.can_sample());
  EXPECT_EQ(environment.radiance({0, 0, 1}), Rgb(1, 2, 3));
  EXPECT_EQ(environment.pdf({0, 0, 1}), 0);
}

TEST(Environment, BlackMapIsFinite) {
  EnvironmentSource source;
  source.map = Image(4, 2);
  const Environment environment(source);
  const Vec3 direction = environment.sample({0.3, 0.6});
  EXPECT_NEAR(length(direction), 1, 1e-12);
  EXPECT_GT(environment.pdf(direction), 0);
  EXPECT_EQ(environment.radiance(direction), Rgb());
}

}  // namespace
}  // namespace sunbeam
