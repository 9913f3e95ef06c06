// A film at many thicknesses at once against the film at one: thin_film.h has tests of its own.
#include "bake/optics/fringes.h"

#include <gtest/gtest.h>

#include <vector>

#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

struct Fringes {
  std::vector<double> reflectance, transmittance;
};

Fringes fringes(const ThinFilm& film, double cosine, double first, double step, std::size_t count) {
  Fringes result{std::vector<double>(count, -1), std::vector<double>(count, -1)};
  film_fringes(film, cosine, first, step, result.reflectance, result.transmittance);
  return result;
}

// Thicknesses are in wavelengths. Up to 400 of them are reached by 50 turns of a rounding error each, 1e-14
// of the phase; ten times that of R, and a hundred times of a small T relative to itself.
void expect_airy(ThinFilm film, double cosine, double first, double step, std::size_t count) {
  const Fringes all = fringes(film, cosine, first, step, count);
  for (std::size_t j = 0; j < count; ++j) {
    film.thickness_nm = first + static_cast<double>(j) * step;
    const FilmPower one = airy(film, cosine, Rgb(1));
    EXPECT_NEAR(all.reflectance[j], one.reflectance.r, 1e-13)
        << film.film_ior << ' ' << film.base_ior << ' ' << cosine << ' ' << film.thickness_nm;
    EXPECT_NEAR(all.transmittance[j], one.transmittance.r, 1e-12 * one.transmittance.r)
        << film.film_ior << ' ' << film.base_ior << ' ' << cosine << ' ' << film.thickness_nm;
  }
}

TEST(Fringes, AreTheFilmAtEachThickness) {
  Rng rng(1, 0);
  for (int k = 0; k < 300; ++k) {
    const ThinFilm film{1, 1 + rng.uniform(), 1 + 1.5 * rng.uniform(), 0};
    expect_airy(film, std::max(0.01, rng.uniform()), 2 * rng.uniform(), 0.05 * rng.uniform(), 400);
  }
}

// Neither the lanes' eight nor any other number of thicknesses is special.
TEST(Fringes, AnyNumberOfThicknesses) {
  for (std::size_t count = 1; count <= 20; ++count) expect_airy({1, 1.56, 1.3, 0}, 0.7, 0.1, 0.03, count);
  EXPECT_TRUE(fringes({1, 1.56, 1.3, 0}, 0.7, 0.1, 0.03, 0).reflectance.empty());
}

TEST(Fringes, NoStepIsOneThickness) {
  expect_airy({1, 1.56, 1.3, 0}, 0.7, 0.4, 0, 11);
  expect_airy({1, 1.56, 1.3, 0}, 0.7, 0, 0, 11);  // no film at all
}

// From below, at grazing and under a film of lower index than both sides.
TEST(Fringes, FromADenserMedium) {
  for (const double cosine : {0.999, 0.9, 0.8, 0.75})
    expect_airy(ThinFilm{1, 1.56, 1.4, 0}.reversed(), cosine, 0, 0.04, 100);
}

// sin > n1 / n0: the wave tunnels, R grows with the thickness, and nothing overflows. airy() itself is used.
TEST(Fringes, EvanescentInTheFilm) {
  const ThinFilm film{1.6, 1.2, 1.5, 0};
  const double cosine = std::sqrt(1 - square(1.3 / 1.6));
  expect_airy(film, cosine, 0, 0.05, 60);
  const Fringes all = fringes(film, cosine, 0.1, 0.05, 60);
  for (std::size_t j = 1; j < 60; ++j) EXPECT_GT(all.reflectance[j], all.reflectance[j - 1]);
}

// n0 sin = n1 and about it, where the film's own cosine is 0: 1.25 * 0.8 = 1. R keeps its digits although it
// is small, from films of next to no thickness on.
TEST(Fringes, KeepDigitsAboutTheFilmsCriticalAngle) {
  ThinFilm film{1.25, 1, 1.3, 0};
  for (const double step : {0.0, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 1e-2})
    for (const double cosine : {0.6 - step, 0.6 + step}) {
      const Fringes all = fringes(film, cosine, 0, 0.01, 400);
      for (std::size_t j = 0; j < 400; ++j) {
        film.thickness_nm = static_cast<double>(j) * 0.01;
        const FilmPower one = airy(film, cosine, Rgb(1));
        EXPECT_NEAR(all.reflectance[j] / one.reflectance.r, 1, 5e-12) << cosine << ' ' << film.thickness_nm;
        EXPECT_NEAR(all.transmittance[j] / one.transmittance.r, 1, 1e-14)
            << cosine << ' ' << film.thickness_nm;
      }
    }
}

TEST(Fringes, TotalReflection) {
  const ThinFilm film = ThinFilm{1, 1.56, 1.4, 0}.reversed();
  for (const double cosine : {0.69, 0.3, 0.0}) {  // sin > 1 / 1.4 below cosines of 0.6999
    const Fringes all = fringes(film, cosine, 0.2, 0.1, 13);
    for (const double r : all.reflectance) EXPECT_EQ(r, 1) << cosine;
    for (const double t : all.transmittance) EXPECT_EQ(t, 0) << cosine;
  }
}

TEST(Fringes, PowersAddUpToOne) {
  Rng rng(2, 0);
  for (int k = 0; k < 100; ++k) {
    const ThinFilm film{1 + rng.uniform(), 1 + rng.uniform(), 1 + rng.uniform(), 0};
    const Fringes all = fringes(film, rng.uniform(), 0, 0.07, 50);
    for (std::size_t j = 0; j < 50; ++j) EXPECT_NEAR(all.reflectance[j] + all.transmittance[j], 1, 1e-12);
  }
}

}  // namespace
}  // namespace sunbeam
