// Clear layered films over a white base send all light back, by every estimator. Fixed seeds; the stated
// rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/exact/exact_bsdf.h"
#include "bake/live/live_bsdf.h"
#include "tests/support/estimates.h"
#include "tests/support/layered_materials.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4);

// Surfaces that lose nothing: 6 of them under 3 films.
std::vector<test::Configuration> furnaces() {
  auto surfaces = test::film_surfaces(Rgb(1));
  std::erase_if(surfaces, [](const test::NamedMaterial& s) {
    return !s.material.is_smooth() && s.material.microfacet == Microfacet::single;
  });
  return test::with_films(test::clear_designs(), surfaces);
}

// What several tests find of 1, and its mean.
struct Furnace {
  Rgb sum, variance;
  int count = 0;

  // To 4.5 standard errors; what is tabulated or integrated is good to 1e-5.
  void add(const test::RgbMean& found, double largest_error, const std::string& what) {
    test::expect_agree(found, Rgb(1), 4.5, 1e-5, what);
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(found[c].std_error(), largest_error) << what;
      sum[c] += found[c].mean();
      variance[c] += square(found[c].std_error());
    }
    ++count;
  }
  void expect_mean(double to) const {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(sum[c] / count, 1, to);
      EXPECT_LE(std::sqrt(variance[c]) / count, to / 4);
    }
  }
};

// 18 materials x 3 channels at 4.5 standard errors (7e-6), 4e-4 in all; their mean at four or more.
TEST(LayeredFurnace, BySampling) {
  Furnace furnace;
  for (const auto& [name, material, wavelengths] : furnaces()) {
    const auto totals = test::sample_totals(LiveBsdf(material, wavelengths), kOblique, 8000, 1);
    furnace.add(totals.albedo, 1.5e-2, name);
  }
  furnace.expect_mean(4e-3);
}

// A walk that carries one wavelength has weight 1 at every step through a smooth film.
TEST(LayeredFurnace, OneWavelengthExactly) {
  for (const auto& [name, material, wavelengths] : furnaces()) {
    if (!material.is_smooth()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto totals =
          test::sample_totals(LiveBsdf(material, test::at_one(wavelengths, k)), kOblique, 500, 2);
      EXPECT_NEAR(totals.albedo.g.mean(), 1, 1e-7) << name;
      EXPECT_LE(totals.albedo.g.std_error(), 1e-7) << name;
      EXPECT_EQ(totals.empty, 0) << name;
    }
  }
}

// 18 materials x 2 techniques x 3 channels at 4.5 standard errors: 7e-4 in all.
TEST(LayeredFurnace, ByIntegration) {
  Furnace furnace;
  for (const auto& [name, material, wavelengths] : furnaces())
    for (const Technique technique : test::kTechniques) {
      const LiveBsdf bsdf(material, wavelengths, technique);
      const Rgb dirac = Pfmc(material, wavelengths).dirac(kOblique);
      Rng rng(3, 0);
      test::RgbMean found;
      for (const Rgb& total : test::integrate_stratified(
               12, 16, rng, [&](const Vec3&wi, Rng&r) { return bsdf.eval(kOblique, wi, r) * wi.z; }))
        found.add(dirac + total);
      furnace.add(found, 1.5e-2, name + ", " + test::name_of(technique));
    }
  furnace.expect_mean(4e-3);
}

// Quadrature serves smooth films here; single facets lose light.
TEST(LayeredFurnace, ByQuadrature) {
  for (const auto& [name, material, wavelengths] : furnaces()) {
    if (!material.is_smooth()) continue;
    for (const double theta : {0.0, 0.9, 1.45}) {
      const Rgb albedo = ExactRest(material, wavelengths).albedo(spherical_direction(theta, 0.4));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(albedo[c], 1, 1e-5) << name << ' ' << theta;
    }
    const ExactBsdf bsdf(material, wavelengths);
    Rng rng(4, 0);
    const auto totals = test::integrate_stratified(
        64, 1, rng, [&](const Vec3& wi, Rng& r) { return bsdf.eval(kOblique, wi, r) * wi.z; });
    const Rgb albedo = bsdf.dirac(kOblique) + totals.front();
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(albedo[c], 1, 2e-3) << name;
  }
}

}  // namespace
}  // namespace sunbeam
