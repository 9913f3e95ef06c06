// The choice of wavelengths for layered films; tests/accuracy/optics measures it on random stacks.
#include "bake/optics/layered/film_nodes.h"

#include <gtest/gtest.h>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr auto kSpace = ColorSpace::acescg;

struct Case {
  Material material;
  FilmDesign film;
};

TEST(FilmNodes, ServeThicknessesUpToTheRefusal) {
  Case c;
  c.film.layers = {{1, OpticalIndex::named("chitin")}};
  const FilmNodes nodes = nodes_for_film(c.material, c.film, Illuminant::d65, kSpace, 300);
  EXPECT_EQ(nodes.quadrature.size(), 16u);
  EXPECT_GT(nodes.path_nm, c.film.path_nm(c.material, 300));
  EXPECT_LE(nodes.path_nm, resolved_path_nm(16));
  Spectrum spectrum(Illuminant::d65, kSpace, nodes.quadrature);
  spectrum.set_film(c.film, nodes.path_nm);
  c.material.film_thickness_nm = nodes.path_nm / c.film.path_nm(c.material, 1) * (1 - 1e-12);
  EXPECT_NO_THROW(spectrum.wavelengths(c.material));
  c.material.film_thickness_nm *= 1.001;
  EXPECT_THROW(spectrum.wavelengths(c.material), Error);
}

Case reflector(double low_ior, int pairs) {
  Case c;
  c.film.layers = {{100, OpticalIndex::constant(2.4)}, {150, OpticalIndex::constant(low_ior)}};
  c.film.periods = pairs;
  return c;
}

// A reflector has finer fringes than its path.
TEST(FilmNodes, TakeMoreThanTheRuleWhereReflectionsAreStrong) {
  const Case c = reflector(2, 5);
  const double thickness = c.film.thickness_nm();
  const FilmNodes nodes = nodes_for_film(c.material, c.film, Illuminant::d65, kSpace, thickness);
  EXPECT_GT(static_cast<int>(nodes.quadrature.size()), nodes_for_path(c.film.path_nm(c.material, thickness)));
  EXPECT_LE(nodes.error, kMostFoldingError);
}

TEST(FilmNodes, SayWhenNoNumberOfThemWillDo) {
  const Case c = reflector(1.38, 8);
  const FilmNodes nodes = nodes_for_film(c.material, c.film, Illuminant::d65, kSpace, c.film.thickness_nm());
  EXPECT_EQ(nodes.quadrature.size(), kMostWavelengths);
  EXPECT_GT(nodes.error, kMostFoldingError);
}

TEST(FilmNodes, NoThicknessAtAllTakesTheFewest) {
  Case c;
  c.film.layers = {{0, OpticalIndex::constant(1.5)}};
  const FilmNodes nodes = nodes_for_film(c.material, c.film, Illuminant::d65, kSpace, 0);
  EXPECT_EQ(nodes.quadrature.size(), 16u);
  EXPECT_EQ(nodes.path_nm, 0);
  EXPECT_LE(nodes.error, kMostFoldingError);
}

}  // namespace
}  // namespace sunbeam
