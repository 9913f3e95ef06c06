// What a recipe's spectrum hands to the live model.
#include "bake/optics/spectrum.h"

#include <gtest/gtest.h>

#include <numeric>

#include "sunbeam/core/error.h"
#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using test::error_of;

const SpectralCurve kOrange{{400, 0.05}, {550, 0.1}, {600, 0.9}, {700, 0.95}};

Material thin(const Rgb& albedo = Rgb(0.5)) {
  Material m;
  m.albedo = albedo;
  return m;
}

Spectrum full(ColorSpace space = ColorSpace::acescg, double path = 2000,
              AbsorptionShape absorption = AbsorptionShape::flat()) {
  return Spectrum(Illuminant::d65, space, path, std::move(absorption));
}

void expect_near(const Rgb& a, const Rgb& b, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

TEST(Spectrum, DefaultIsThePapersThreeWavelengths) {
  const Material m = thin({0.1, 0.2, 0.3});
  const Wavelengths w = Spectrum().wavelengths(m), expected = Wavelengths::rgb3(m);
  EXPECT_FALSE(Spectrum().is_full());
  EXPECT_EQ(Spectrum().color_space(), ColorSpace::rec709);
  EXPECT_EQ(w.nm, expected.nm);
  EXPECT_EQ(w.albedo, expected.albedo);
  EXPECT_EQ(Spectrum().monochromatic(m, 555).albedo, std::vector<double>{0.1});
  EXPECT_EQ(Spectrum().from_rec709({0.1, 0.2, 0.3}), Rgb(0.1, 0.2, 0.3));
  EXPECT_EQ(Spectrum().attributes(), (std::map<std::string, std::string>{{"spectrum", "rgb3"}}));
}

TEST(Spectrum, AlbedoFoldsBackInEverySpaceAndIlluminant) {
  for (const auto illuminant : {Illuminant::d65, Illuminant::e})
    for (const auto space : {ColorSpace::rec709, ColorSpace::acescg})
      for (const Rgb& rec709 : {Rgb(0.7, 0.3, 0.1), Rgb(0.5), Rgb(1, 0, 0), Rgb(0, 0, 1), Rgb(1), Rgb(0)}) {
        Spectrum spectrum(illuminant, space, 2000);
        const Rgb albedo = spectrum.from_rec709(rec709);
        const Wavelengths direct = spectrum.wavelengths(thin(albedo));
        spectrum.set_albedo(albedo);
        const Wavelengths kept = spectrum.wavelengths(thin(albedo));
        expect_near(direct.fold(direct.albedo), albedo, 1e-8);
        EXPECT_EQ(kept.albedo, direct.albedo);
        expect_near(rgb_to_rgb(space, ColorSpace::rec709) * kept.fold(kept.albedo), rec709, 1e-8);
      }
}

TEST(Spectrum, EveryRec709ColourHasASpectrumAtEveryNumberOfNodes) {
  for (const double path : {2000.0, 5000.0, 8000.0, 11000.0, 17000.0})
    for (const auto space : {ColorSpace::rec709, ColorSpace::acescg})
      for (int corner = 0; corner < 8; ++corner) {
        const Spectrum spectrum = full(space, path);
        const Rgb albedo =
            spectrum.from_rec709({static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1),
                                  static_cast<double>(corner >> 2)});
        const Wavelengths w =
            spectrum.wavelengths(thin(transform(albedo, [](double x) { return std::min(x, 1.0); })));
        expect_near(w.fold(w.albedo), albedo, 1e-8);
      }
}

TEST(Spectrum, SpectralAlbedoBelongsToItsFold) {
  Spectrum spectrum = full();
  const Rgb albedo = spectrum.set_albedo(kOrange);
  const Wavelengths w = spectrum.wavelengths(thin(albedo));
  expect_near(w.fold(w.albedo), albedo, 1e-12);
  for (std::size_t k = 0; k < w.size(); ++k) EXPECT_DOUBLE_EQ(w.albedo[k], interpolate(kOrange, w.nm[k]));
  EXPECT_NEAR(spectrum.monochromatic(thin(albedo), 575).albedo[0], 0.5, 1e-12);
  // Another albedo is uplifted instead.
  const Wavelengths grey = spectrum.wavelengths(thin(Rgb(0.25)));
  for (const double value : grey.albedo) EXPECT_NEAR(value, 0.25, 1e-12);
  // White, whose fold may round to more than 1, stays an albedo.
  EXPECT_LE(max_component(spectrum.set_albedo(SpectralCurve{{400, 1}, {700, 1}})), 1);
}

TEST(Spectrum, SaturatedSpectraKeepTheirValuesOutsideTheGamut) {
  Spectrum spectrum = full(ColorSpace::rec709);
  const SpectralCurve cyan{{480, 0}, {490, 1}, {510, 1}, {520, 0}};
  const Rgb albedo = spectrum.set_albedo(cyan);
  const Wavelengths w = spectrum.wavelengths(thin(albedo));
  EXPECT_EQ(albedo.r, 0);
  EXPECT_LT(w.fold(w.albedo).r, -0.01);
}

TEST(Spectrum, AbsorptionIsRelativeTo510Nm) {
  const Spectrum spectrum = full(ColorSpace::acescg, 2000, AbsorptionShape::pigment("eumelanin"));
  const Wavelengths w = spectrum.wavelengths(thin());
  for (std::size_t k = 0; k < w.size(); ++k) EXPECT_DOUBLE_EQ(w.absorption[k], std::pow(510 / w.nm[k], 3.48));
  EXPECT_DOUBLE_EQ(spectrum.monochromatic(thin(), 510).absorption[0], 1);
  EXPECT_DOUBLE_EQ(full().monochromatic(thin(), 400).absorption[0], 1);
}

TEST(Spectrum, MonochromaticJoinsTheUpliftedNodes) {
  Spectrum spectrum = full();
  const Rgb albedo = spectrum.from_rec709({0.7, 0.3, 0.1});
  spectrum.set_albedo(albedo);
  const Material m = thin(albedo);
  const Wavelengths w = spectrum.wavelengths(m);
  for (std::size_t k = 0; k + 1 < w.size(); ++k) {
    EXPECT_DOUBLE_EQ(spectrum.monochromatic(m, w.nm[k]).albedo[0], w.albedo[k]);
    EXPECT_NEAR(spectrum.monochromatic(m, (w.nm[k] + w.nm[k + 1]) / 2).albedo[0],
                (w.albedo[k] + w.albedo[k + 1]) / 2, 1e-12);
  }
  EXPECT_EQ(spectrum.monochromatic(m, 900).weight, std::vector{Rgb(1)});
}

TEST(Spectrum, NodesFollowTheLongestPathUpToTheLimit) {
  for (const double path : {0.0, 2000.0, 5400.0, 9000.0, 17280.0}) {
    const Spectrum spectrum = full(ColorSpace::acescg, path);
    Material m = thin();
    m.film_thickness_nm = path / (2 * m.film_ior);
    const Wavelengths w = spectrum.wavelengths(m);
    EXPECT_EQ(w.size(), static_cast<std::size_t>(nodes_for_path(path)));
    EXPECT_LE(w.size(), kMostWavelengths);
    const Rgb sum = std::accumulate(w.weight.begin(), w.weight.end(), Rgb());
    expect_near(sum, Rgb(1), 1e-12);
    m.film_thickness_nm = resolved_path_nm(w.size()) / (2 * m.film_ior) + 1;
    EXPECT_NE(error_of([&] { spectrum.wavelengths(m); }).find("'film_thickness_nm'"), std::string::npos);
    spectrum.monochromatic(m, 550);  // needs no fold
  }
  EXPECT_NE(error_of([] { full(ColorSpace::acescg, 17281); }).find("up to 17280"), std::string::npos);
}

TEST(Spectrum, AttributesSayWhatTheColoursAre) {
  const auto attributes = Spectrum(Illuminant::e, ColorSpace::rec709, 0).attributes();
  EXPECT_EQ(attributes.at("spectrum"), "full");
  EXPECT_EQ(attributes.at("color_space"), "rec709");
  EXPECT_EQ(attributes.at("illuminant"), "E");
  EXPECT_EQ(attributes.at("wavelengths").substr(0, 4), "395 ");
}

}  // namespace
}  // namespace sunbeam
