// What a recipe's film and base become at wavelengths.
#include "bake/optics/dispersion/film_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bake/optics/spectrum.h"
#include "sunbeam/detail/layered_film.h"
#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using test::error_of;
using ::testing::HasSubstr;

FilmDesign chitin_and_air() {
  FilmDesign film;
  film.layers = {{90, OpticalIndex::named("chitin")}, {60, OpticalIndex::constant(1)}};
  film.periods = 4;
  return film;
}

TEST(FilmDesign, AddsUpThicknessAndPath) {
  const FilmDesign film = chitin_and_air();
  EXPECT_EQ(film.thickness_nm(), 600);
  const double n = OpticalIndex::named("chitin").at(380).real();
  EXPECT_NEAR(film.path_nm(Material(), 600), 2 * 4 * (90 * n + 60), 1e-9);
  EXPECT_NEAR(film.path_nm(Material(), 300), 4 * (90 * n + 60), 1e-9);
  EXPECT_EQ(FilmDesign().path_nm(Material(), 250), 2 * Material().film_ior * 250);
}

TEST(FilmDesign, LayersOfNoThicknessMakeNone) {
  FilmDesign film;
  film.layers = {{0, OpticalIndex::constant(1.5)}};
  EXPECT_TRUE(film.reaches(0));
  EXPECT_FALSE(film.reaches(1));
  EXPECT_EQ(film.path_nm(Material(), 0), 0);
  EXPECT_TRUE(FilmDesign().reaches(1));
}

TEST(FilmDesign, NothingIsFilledInForOneClearFilm) {
  for (Wavelengths w : {Spectrum().wavelengths(Material()), Spectrum().monochromatic(Material(), 550)}) {
    EXPECT_TRUE(w.layers.empty());
    EXPECT_TRUE(w.base_index.empty());
    EXPECT_EQ(w.film_periods, 1);
  }
}

TEST(FilmDesign, IndicesAreThoseOfTheWavelengths) {
  Spectrum spectrum;
  FilmDesign film = chitin_and_air();
  film.base = OpticalIndex::named("Ti");
  spectrum.set_film(film, 0);
  Material material;
  material.film_thickness_nm = 600;
  const Wavelengths w = spectrum.wavelengths(material);
  ASSERT_EQ(w.layers.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(w.layers[k][0].index, OpticalIndex::named("chitin").at(w.nm[k]));
    EXPECT_EQ(w.layers[k][1].index, 1.0);
    EXPECT_EQ(w.base_index[k], OpticalIndex::named("Ti").at(w.nm[k]));
  }
  EXPECT_EQ(w.film_periods, 4);
  EXPECT_TRUE(is_layered(material, w));
}

TEST(FilmDesign, ABaseIsClearIfItAbsorbsNextToNothing) {
  EXPECT_FALSE(is_opaque(OpticalIndex::named("water")));
  EXPECT_FALSE(is_opaque(OpticalIndex::constant(1.5, kClearExtinction)));
  EXPECT_TRUE(is_opaque(OpticalIndex::constant(1.5, 2 * kClearExtinction)));
  EXPECT_TRUE(is_opaque(OpticalIndex::measured({{400, 1.5, 0}, {600, 1.5, 0}, {700, 1.5, 0.01}})));
  FilmDesign film;
  film.base = OpticalIndex::named("water");
  EXPECT_GT(film.base->at(550).imag(), 0);
  EXPECT_EQ(film.base_at(550), film.base->at(550).real());
  EXPECT_THAT(error_of([&] { film.base_at(3000); }), HasSubstr("key 'base_ior': found k = 0.272 at 3000 nm"));
  film.base = OpticalIndex::named("Ti");
  EXPECT_EQ(film.base_at(550), film.base->at(550));
}

TEST(FilmDesign, NamesTheLayerWhoseIndexIsNotKnown) {
  Spectrum spectrum;
  spectrum.set_film(chitin_and_air(), 0);
  EXPECT_THAT(error_of([&] { spectrum.monochromatic(Material(), 2000); }),
              HasSubstr("layer 1 of the film: found the wavelength 2000 nm"));
}

}  // namespace
}  // namespace sunbeam
