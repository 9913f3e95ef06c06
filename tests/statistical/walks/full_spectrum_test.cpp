// The live model with all wavelengths at once: folded, it is the same as one wavelength after the other.
#include <gtest/gtest.h>

#include "bake/live/live_bsdf.h"
#include "bake/optics/spectrum.h"
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

}  // namespace
}  // namespace sunbeam
