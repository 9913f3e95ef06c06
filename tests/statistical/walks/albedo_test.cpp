// The directional albedo of the live model by three ways: integrating eval(), sampling lights without regard
// to the surface, and sample(). In every configuration, and where it is known to be one. Fixed seeds; the
// stated rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include <algorithm>

#include "bake/live/exact/exact.h"
#include "bake/live/live_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/configurations.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4);
constexpr double kKnown = 3.5e-4;  // relative standard error of every albedo, in every channel
constexpr int kGrid = 16;          // 256 directions at a time

// Means of once(), `least` of them and then until every channel is known to kKnown.
template <class Once>
test::RgbMean until_known(int least, Once once) {
  test::RgbMean mean;
  const auto is_known = [&](int c) { return mean[c].std_error() <= kKnown * mean[c].mean(); };
  do
    for (int i = 0; i < least; ++i) mean.add(once());
  while (mean.r.count() < 10000000 && !(is_known(0) && is_known(1) && is_known(2)));
  return mean;
}

test::RgbMean by_integrating(const Bsdf& bsdf, const Vec3& wo, const Rgb& dirac) {
  Rng rng(2, 0);
  const auto f = [&](const Vec3& wi, Rng& r) { return bsdf.eval(wo, wi, r) * wi.z; };
  return until_known(64, [&] { return dirac + test::integrate_stratified(kGrid, 1, rng, f)[0]; });
}

// What a renderer does that samples its lights, here a cosine-weighted dome.
test::RgbMean by_lights(const Bsdf& bsdf, const Vec3& wo, const Rgb& dirac) {
  Rng rng(3, 0);
  const auto lit = [&](const Point2& u, Rng& r) {
    const Vec3 wi = sample_cosine(u);
    return bsdf.eval(wo, wi, r) * (wi.z / cosine_pdf(wi.z));
  };
  return until_known(64, [&] { return dirac + test::stratified_mean(kGrid, rng, lit); });
}

test::RgbMean by_sampling(const Bsdf& bsdf, const Vec3& wo) {
  Rng rng(4, 0);
  return until_known(10000, [&] {
    const auto s = bsdf.sample(wo, rng);
    return s ? s->throughput : Rgb();
  });
}

// To 4.5 standard errors; `slack` is the relative error of `expected`.
void expect_albedo(const test::RgbMean& found, const Rgb& expected, double slack, const std::string& what) {
  for (int c = 0; c < 3; ++c) {
    const double error = found[c].std_error();
    EXPECT_LE(error, 1.01 * kKnown * expected[c]) << what << " channel " << c;
    EXPECT_NEAR(found[c].mean(), expected[c], 4.5 * error + slack * expected[c]) << what << " channel " << c;
  }
}

void expect_one_per_mille(const Rgb& found, const Rgb& expected, const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(found[c], expected[c], 1e-3 * expected[c]) << what << " channel " << c;
}

// Of a lower index than skin's, which takes fewer internal reflections and so less time to this precision.
std::vector<test::Configuration> configurations() {
  auto materials = test::all_modes();
  for (auto& [name, material] : materials) material.base_ior = 1.2;
  return test::in_both_spectra(materials);
}

class ThreeWays : public ::testing::TestWithParam<int> {};

// Each way to 4.5 of its standard errors, that is at worst to 0.17 %, and the mean of the three to 0.1 %. The
// exact albedo is good to 1e-4. 16 x 3 x 3 tests: 1e-3 in all. The mean adds 48 at 4.4 standard errors or
// more: 5e-4.
TEST_P(ThreeWays, AgreeWithTheExactAlbedo) {
  const auto [name, material, wavelengths] = configurations()[GetParam()];
  const LiveBsdf bsdf(material, wavelengths);
  const Rgb dirac = Pfmc(material, wavelengths).dirac(kOblique);
  const Rgb exact = ExactRest(material, wavelengths).albedo(kOblique);
  const auto integrated = by_integrating(bsdf, kOblique, dirac);
  const auto lit = by_lights(bsdf, kOblique, dirac);
  const auto sampled = by_sampling(bsdf, kOblique);
  expect_albedo(integrated, exact, 1e-4, "eval");
  expect_albedo(lit, exact, 1e-4, "lights");
  expect_albedo(sampled, exact, 1e-4, "sample");
  expect_one_per_mille((integrated.mean() + lit.mean() + sampled.mean()) * (1.0 / 3), exact, "mean");
}

// The probabilities of all outcomes make up one. 16 tests at 4.5 standard errors: 1e-4 in all.
TEST_P(ThreeWays, ProbabilitiesSumToOne) {
  const auto [name, material, wavelengths] = configurations()[GetParam()];
  const LiveBsdf bsdf(material, wavelengths);
  const auto density = test::integrate_pdf(bsdf, kOblique, 80, 64, 5);
  const auto sampled = test::sample_totals(bsdf, kOblique, 400000, 5);
  const double error = std::hypot(density.std_error(), sampled.seen.std_error());
  EXPECT_NEAR(density.mean() + sampled.dirac + sampled.empty, 1, 4.5 * error);
  EXPECT_LE(error, 1.5e-3);
}

INSTANTIATE_TEST_SUITE_P(Albedo, ThreeWays, ::testing::Range(0, 16), [](const auto& info) {
  std::string name = configurations()[info.param].name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

// A smooth film over a white base without pigment: all light comes back.
Material furnace(Transmission transmission) {
  Material m;
  m.transmission = transmission;
  m.film_thickness_nm = 350;
  m.base_ior = 1.2;
  m.absorption_per_nm = 0;
  m.albedo = Rgb(1);
  m.roughness = 0;
  return m;
}

const double kFurnaceAngles[] = {0.0, 0.8, 1.4};

// A walk that carries one wavelength has weight 1 at every step.
TEST(WhiteFurnace, OneWavelengthExactly) {
  for (const auto transmission : {Transmission::straight, Transmission::refract})
    for (const double theta : kFurnaceAngles) {
      const Material material = furnace(transmission);
      const LiveBsdf bsdf(material, Wavelengths::monochromatic(material, 550));
      const auto totals = test::sample_totals(bsdf, spherical_direction(theta, 0), 2000, 3);
      EXPECT_NEAR(totals.albedo.g.mean(), 1, 1e-9) << to_string(transmission) << ' ' << theta;
      EXPECT_EQ(totals.empty, 0);
    }
}

// By eval and by sampling to 4.5 standard errors: 2 transmissions x 2 spectra x 3 angles x 3 channels x 2 are
// 72 tests, 5e-4 in all. The mean over the angles by eval to 0.1 %: 12 at nearly 5, 1e-5.
TEST(WhiteFurnace, EveryChannel) {
  for (const auto transmission : {Transmission::straight, Transmission::refract})
    for (const auto& [colour, spectrum] : test::both_spectra()) {
      const Material m = furnace(transmission);
      const Wavelengths w = spectrum.wavelengths(m);
      const LiveBsdf bsdf(m, w);
      const std::string name = std::string(to_string(transmission)) + ' ' + colour;
      Rgb sum;
      for (const double theta : kFurnaceAngles) {
        const Vec3 wo = spherical_direction(theta, 0);
        const auto integrated = by_integrating(bsdf, wo, Pfmc(m, w).dirac(wo));
        expect_albedo(integrated, Rgb(1), 1e-9, name + " eval at " + std::to_string(theta));
        sum += integrated.mean();
        const auto sampled = test::sample_totals(bsdf, wo, 100000, 4).albedo;
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(sampled[c].mean(), 1, 4.5 * sampled[c].std_error()) << name << ' ' << theta;
          EXPECT_LE(sampled[c].std_error(), 4e-3) << name << ' ' << theta;
        }
      }
      expect_one_per_mille(sum * (1.0 / 3), Rgb(1), name);
    }
}

}  // namespace
}  // namespace sunbeam
