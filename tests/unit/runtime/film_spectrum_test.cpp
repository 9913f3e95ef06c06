// FilmSpectrum against the film in doubles, for every instruction set that this machine has.
#include "runtime/src/film/film_spectrum.h"

#include <gtest/gtest.h>

#include <sstream>

#include "bake/optics/spectrum.h"
#include "bake/optics/thin_film.h"
#include "runtime/src/film/film_kernels.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

constexpr double kReflectanceError = 1e-6, kTransmittanceError = 2e-6;  // as film_spectrum.h states

struct Case {
  ThinFilm film;
  float cosine;
};

const Wavelengths& three() {
  static const Wavelengths wavelengths = Wavelengths::rgb3(Material());
  return wavelengths;
}

const Wavelengths& twenty() {
  static const Wavelengths wavelengths =
      Spectrum(Illuminant::d65, ColorSpace::acescg, resolved_path_nm(20)).wavelengths(Material());
  return wavelengths;
}

std::vector<double> exact_transmittances(const Case& c, const Wavelengths& wavelengths) {
  std::vector<double> t;
  for (const double nm : wavelengths.nm) t.push_back(airy(c.film, c.cosine, Rgb(nm)).transmittance.r);
  return t;
}

struct Errors {
  double reflectance = 0, fold = 0, relative_transmittance = 0;

  void include(const Errors& o) {
    reflectance = std::max(reflectance, o.reflectance);
    fold = std::max(fold, o.fold);
    relative_transmittance = std::max(relative_transmittance, o.relative_transmittance);
  }
};

std::vector<float> transmittances(const Case& c, const Wavelengths& wavelengths, const FilmKernels& kernels) {
  const FilmSpectrum spectrum(wavelengths, c.film.exterior_ior, c.film.film_ior, kernels);
  std::vector<float> t(spectrum.padded_count());
  spectrum.powers(c.film.thickness_nm, c.film.base_ior, c.cosine, t.data());
  return t;
}

Rgb folded(const Case& c, const Wavelengths& wavelengths, const FilmKernels& kernels) {
  const FilmSpectrum spectrum(wavelengths, c.film.exterior_ior, c.film.film_ior, kernels);
  FloatRgb rgb;
  spectrum.fold(c.film.thickness_nm, c.film.base_ior, {&c.cosine, 1}, &rgb);
  return {rgb.r, rgb.g, rgb.b};
}

Errors errors(const Case& c, const Wavelengths& wavelengths, const FilmKernels& kernels) {
  const std::vector<double> expected = exact_transmittances(c, wavelengths);
  const std::vector<float> found = transmittances(c, wavelengths, kernels);
  Errors e;
  std::vector<double> reflectances;
  double largest_weight = 0;
  for (std::size_t k = 0; k < wavelengths.size(); ++k) {
    const double difference = std::abs(found[k] - expected[k]);
    e.reflectance = std::max(e.reflectance, difference);
    if (expected[k] > 1e-37)
      e.relative_transmittance = std::max(e.relative_transmittance, difference / expected[k]);
    if (!std::isfinite(found[k]) || found[k] < 0) e.reflectance = INFINITY;
    reflectances.push_back(1 - expected[k]);
  }
  Rgb magnitude;
  for (const Rgb& w : wavelengths.weight) magnitude += transform(w, [](double x) { return std::abs(x); });
  largest_weight = max_component(magnitude);
  const Rgb difference = folded(c, wavelengths, kernels) - wavelengths.fold(reflectances);
  e.fold = max_component(transform(difference, [](double x) { return std::abs(x); })) / largest_weight;
  if (!is_finite(difference)) e.fold = INFINITY;
  return e;
}

// Of both spectra and all instruction sets.
Errors worst_errors(const Case& c) {
  Errors worst;
  for (const FilmKernels* kernels : supported_film_kernels())
    for (const Wavelengths* wavelengths : {&three(), &twenty()})
      worst.include(errors(c, *wavelengths, *kernels));
  return worst;
}

std::string describe(const Case& c) {
  const ThinFilm& f = c.film;
  std::ostringstream text;
  text.precision(9);
  text << f.exterior_ior << '|' << f.film_ior << '|' << f.base_ior << ", " << f.thickness_nm << " nm, cosine "
       << c.cosine;
  return text.str();
}

void expect_accurate(const Case& c) {
  const Errors e = worst_errors(c);
  EXPECT_LE(e.reflectance, kReflectanceError) << describe(c);
  EXPECT_LE(e.fold, kReflectanceError) << describe(c);
  if (c.cosine >= 1e-3f) {
    EXPECT_LE(e.relative_transmittance, kTransmittanceError) << describe(c);
  }
}

float draw_cosine(Rng& rng) {
  const double u = rng.uniform();
  return static_cast<float>(rng.uniform() < 0.5 ? u : std::pow(1e-3, u));
}

void expect_accurate_over(double lowest_exterior, double highest_exterior, double lowest_film, int cases) {
  Rng rng(1, 0);
  Errors worst;
  for (int i = 0; i < cases; ++i) {
    const double n0 = lerp(rng.uniform(), lowest_exterior, highest_exterior);
    const Case c{
        {n0, lerp(rng.uniform(), lowest_film, 2.5), lerp(rng.uniform(), 1, 2.5), 3000 * rng.uniform()},
        draw_cosine(rng)};
    const Errors e = worst_errors(c);
    worst.include(e);
    if (e.reflectance > kReflectanceError || e.relative_transmittance > kTransmittanceError)
      ADD_FAILURE() << describe(c) << ": R " << e.reflectance << ", T " << e.relative_transmittance;
  }
  EXPECT_LE(worst.fold, kReflectanceError);
  ::testing::Test::RecordProperty("worst_reflectance", std::to_string(worst.reflectance * 1e9));
  ::testing::Test::RecordProperty("worst_fold", std::to_string(worst.fold * 1e9));
  ::testing::Test::RecordProperty("worst_transmittance", std::to_string(worst.relative_transmittance * 1e9));
}

TEST(FilmSpectrum, AgreesInAir) { expect_accurate_over(1, 1, 1, 20000); }

// Total reflection, plain and frustrated.
TEST(FilmSpectrum, AgreesInDenseMedia) { expect_accurate_over(1, 2.5, 1, 20000); }

constexpr double kIndices[] = {1, 1.25, 1.5, 2.5};
constexpr double kThicknesses[] = {0, 1e-3, 1, 300, 3000};

TEST(FilmSpectrum, AgreesForEqualMediaAndExtremeCosines) {
  for (const double n0 : kIndices)
    for (const double n1 : kIndices)
      for (const double n2 : kIndices)
        for (const double thickness : kThicknesses)
          for (const float cosine : {1e-7f, 1e-5f, 1e-3f, 1e-2f, 0.3f, 0.6f, 0.8f, 0.99f, 1.0f})
            expect_accurate({{n0, n1, n2, thickness}, cosine});
}

// n0 sin = n1 (exactly: 1.25 * 0.8 = 1) and the nearest floats about it, where the film's cosine is 0.
TEST(FilmSpectrum, AgreesWhereTheFilmAngleIsGrazing) {
  for (const double n2 : {1.1, 1.5, 2.5})
    for (const double thickness : kThicknesses)
      for (const float cosine :
           {0.6f, std::nextafter(0.6f, 0.0f), std::nextafter(0.6f, 1.0f), 0.6f - 1e-5f, 0.6f + 1e-5f})
        expect_accurate({{1.25, 1, n2, thickness}, cosine});
}

// About n0 sin = n2, where total reflection begins.
TEST(FilmSpectrum, AgreesAboutTheCriticalAngle) {
  for (const double n1 : {1.05, 1.2, 1.4, 2.0})
    for (const double thickness : kThicknesses)
      for (const double sine : {0.8 + 1e-6, 0.8 - 1e-6, 0.8 - 1e-4})
        expect_accurate({{1.5, n1, 1.2, thickness}, static_cast<float>(std::sqrt(1 - square(sine)))});
}

void expect_all_reflected(const Case& c) {
  for (const FilmKernels* kernels : supported_film_kernels()) {
    for (const float t : transmittances(c, twenty(), *kernels)) EXPECT_EQ(t, 0) << describe(c);
    EXPECT_EQ(folded(c, three(), *kernels), Rgb(1)) << describe(c);
  }
}

TEST(FilmSpectrum, TotalReflectionIsExact) {
  for (const double n1 : {1.05, 1.2, 1.4, 2.0})
    for (const double thickness : kThicknesses)
      for (const float cosine : {0.0f, 1e-3f, 0.3f, 0.59f})
        expect_all_reflected({{1.5, n1, 1.2, thickness}, cosine});
}

TEST(FilmSpectrum, CosineZeroReflectsAll) {
  for (const double n0 : kIndices)
    for (const double n1 : kIndices)
      for (const double n2 : kIndices)
        for (const double thickness : kThicknesses) expect_all_reflected({{n0, n1, n2, thickness}, 0});
}

// So thick that exp overflows floats.
TEST(FilmSpectrum, DeepEvanescentWaveReflectsAll) {
  const Case c{{2.5, 1, 2.5, 1e5}, 0.3f};
  expect_all_reflected(c);
}

// Each cosine of a list gets what it gets alone, whatever its place and whatever its neighbours.
TEST(FilmSpectrum, ListsAreAsGoodAsSingleCosines) {
  const float cosines[] = {0.9f, 0, 0.1f, 0.5f, 1, 1e-3f, 0.7f, 0.45f, 0.2f};
  for (const FilmKernels* kernels : supported_film_kernels())
    for (const double film_ior : {1.56, 1.2}) {  // the second is evanescent for some
      const FilmSpectrum spectrum(twenty(), 1.33, film_ior, *kernels);
      for (std::size_t count = 0; count <= std::size(cosines); ++count) {
        FloatRgb rgb[std::size(cosines) + 1];
        spectrum.fold(450, 1.5, {cosines, count}, rgb);
        for (std::size_t i = 0; i < count; ++i) {
          const Rgb alone = folded({{1.33, film_ior, 1.5, 450}, cosines[i]}, twenty(), *kernels);
          EXPECT_NEAR(rgb[i].r, alone.r, 1e-6);
          EXPECT_NEAR(rgb[i].g, alone.g, 1e-6);
          EXPECT_NEAR(rgb[i].b, alone.b, 1e-6);
        }
        EXPECT_EQ(rgb[count].r, 0) << "written beyond the list";
      }
    }
}

TEST(FilmSpectrum, InstructionSetsAgree) {
  const FilmKernels& baseline = *supported_film_kernels().front();
  Rng rng(2, 0);
  for (int i = 0; i < 5000; ++i) {
    const Case c{{1, 1 + rng.uniform(), 1 + rng.uniform(), 3000 * rng.uniform()}, draw_cosine(rng)};
    const std::vector<float> expected = transmittances(c, twenty(), baseline);
    for (const FilmKernels* kernels : supported_film_kernels()) {
      const std::vector<float> found = transmittances(c, twenty(), *kernels);
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_NEAR(found[k], expected[k], kReflectanceError) << kernels->name << ' ' << describe(c);
        EXPECT_NEAR(found[k] / expected[k], 1, kTransmittanceError) << kernels->name << ' ' << describe(c);
      }
    }
  }
}

Wavelengths evenly_spaced(std::size_t count) {
  Wavelengths w;
  for (std::size_t k = 0; k < count; ++k) {
    w.nm.push_back(380 + static_cast<double>(400 * k) / static_cast<double>(count));
    w.weight.push_back(Rgb(1.0 / static_cast<double>(count)));
  }
  return w;
}

TEST(FilmSpectrum, AnyNumberOfWavelengths) {
  for (std::size_t count = 1; count <= kMostWavelengths; ++count) {
    const Wavelengths wavelengths = evenly_spaced(count);
    const FilmSpectrum spectrum(wavelengths, 1, 1.5);
    EXPECT_EQ(spectrum.count(), count);
    EXPECT_EQ(spectrum.padded_count() % 16, 0u);
    EXPECT_GE(spectrum.padded_count(), count);
    EXPECT_LT(spectrum.padded_count(), count + 16);
    for (const FilmKernels* kernels : supported_film_kernels()) {
      const Errors e = errors({{1, 1.5, 2, 400}, 0.7f}, wavelengths, *kernels);
      EXPECT_LE(e.fold, kReflectanceError) << count;
      EXPECT_LE(e.reflectance, kReflectanceError) << count;
    }
  }
  EXPECT_THROW(FilmSpectrum(Wavelengths(), 1, 1.5), Error);
  EXPECT_THROW(FilmSpectrum(evenly_spaced(kMostWavelengths + 1), 1, 1.5), Error);
}

}  // namespace
}  // namespace sunbeam
