// The live model with all wavelengths at once: folded, it is the same as one wavelength after the other.
#include <gtest/gtest.h>

#include "bake/live/live_bsdf.h"
#include "bake/live/spectrum.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/materials.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const Vec3 kSteep = spherical_direction(0.3, 2.5);

struct Skin {
  Material material;
  Spectrum spectrum;
};

// An orange base under eumelanin.
Skin skin(const Material& material) {
  Skin skin{material,
            Spectrum(Illuminant::d65, ColorSpace::acescg, 2000, AbsorptionShape::pigment("eumelanin"))};
  skin.material.albedo =
      skin.spectrum.set_albedo(SpectralCurve{{400, 0.3}, {550, 0.4}, {600, 0.9}, {700, 0.95}});
  return skin;
}

// 8 x 3 tests at 4.5 standard errors: 2e-4 in all. The exact parts agree to rounding.
TEST(FullSpectrum, IsTheFoldOfItsWavelengths) {
  constexpr int kWalks = 20000;
  for (const auto& [name, material] : test::all_modes()) {
    const auto [m, spectrum] = skin(material);
    const Wavelengths w = spectrum.wavelengths(m);
    const Pfmc all(m, w);
    Rng rng(1, 0);
    test::RgbMean rest;
    for (int i = 0; i < kWalks; ++i) rest.add(all.estimate_rest(kOblique, kSteep, rng));
    std::vector<double> first, film, value;
    Rgb variance;
    for (std::size_t k = 0; k < w.size(); ++k) {
      const Pfmc one(m, spectrum.monochromatic(m, w.nm[k]));
      first.push_back(one.first(kOblique, kSteep).g);
      film.push_back(one.film_reflectance(0.4).g);
      test::RunningMean mean;
      for (int i = 0; i < kWalks; ++i) mean.add(one.estimate_rest(kOblique, kSteep, rng).g);
      value.push_back(mean.mean());
      variance += square(mean.std_error()) * (w.weight[k] * w.weight[k]);
    }
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(all.first(kOblique, kSteep)[c], w.fold(first)[c], 1e-12) << name;
      EXPECT_NEAR(all.film_reflectance(0.4)[c], w.fold(film)[c], 1e-12) << name;
      EXPECT_LT(test::deviation(rest[c].mean(), rest[c].std_error(), w.fold(value)[c], std::sqrt(variance[c]),
                                1e-9),
                4.5)
          << name << " channel " << c << ": " << rest[c].mean() << " and " << w.fold(value)[c];
    }
  }
}

Material furnace(Transmission transmission) {
  Material m;
  m.transmission = transmission;
  m.base_ior = 1.2;
  m.absorption_per_nm = 0;
  m.albedo = Rgb(1);
  m.roughness = 0;
  return m;
}

// Nothing absorbs: white in every channel. 2 x 3 x 3 tests at 4.5 standard errors by eval, 18 more by
// sampling.
TEST(FullSpectrum, WhiteFurnace) {
  for (const auto transmission : {Transmission::straight, Transmission::refract})
    for (const double theta : {0.0, 0.6, 1.2}) {
      const Material m = furnace(transmission);
      const Wavelengths w = Spectrum(Illuminant::d65, ColorSpace::acescg, 2000).wavelengths(m);
      const LiveBsdf bsdf(m, w);
      const Vec3 wo = spherical_direction(theta, 0);
      const Rgb dirac = Pfmc(m, w).dirac(wo);
      const auto evaluated = test::albedo_by_eval(bsdf, wo, 20, 16, 5);
      const auto sampled = test::sample_totals(bsdf, wo, 40000, 4).albedo;
      for (int c = 0; c < 3; ++c) {
        // 16 repeats: Student's t.
        EXPECT_NEAR(dirac[c] + evaluated[c].mean(), 1, 6 * evaluated[c].std_error() + 1e-9)
            << to_string(transmission) << ' ' << theta << " channel " << c;
        EXPECT_LT(evaluated[c].std_error(), 0.01);
        EXPECT_NEAR(sampled[c].mean(), 1, 4.5 * sampled[c].std_error() + 1e-9)
            << to_string(transmission) << ' ' << theta << " channel " << c;
      }
    }
}

// 8 tests, false alarm 1e-3 in all.
TEST(FullSpectrum, SamplesFollowThePdf) {
  for (const auto& [name, material] : test::all_modes()) {
    const auto [m, spectrum] = skin(material);
    const auto result =
        test::chi_square_of_sampling(LiveBsdf(m, spectrum.wavelengths(m)), kOblique, {.samples = 50000}, 1);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 8)) << name;
  }
}

}  // namespace
}  // namespace sunbeam
