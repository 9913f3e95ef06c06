// The folded powers of films, which dense tables hold, against curves of them and single films.
#include "bake/dense/film_colors.h"

#include <gtest/gtest.h>

#include "bake/base/error_floor.h"
#include "bake/dense/film_arrays.h"
#include "bake/dense/film_axes.h"
#include "bake/optics/thin_film.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/film_curves.h"
#include "tests/support/layered_films.h"

namespace sunbeam {
namespace {

constexpr std::array kAll{0, 1, 2};

Rgb first_three(const FilmPowers::Numbers& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

// What walks carry comes from the curves, right to 1e-10, and three wavelengths are the channels.
TEST(FilmColors, AreThoseOfTheWalks) {
  Material above, below;
  above.base_ior = 1.5;
  below.exterior_ior = 1.5;
  below.base_ior = 1.33;
  auto films = test::layered_films(above);
  for (const auto& film : test::layered_films(below)) films.push_back(film);
  films.push_back(test::opaque(above));
  Rng rng(1, 0);
  for (const auto& [name, material, wavelengths] : films) {
    const FilmColors colors(material, wavelengths);
    const FilmCurves curves(material, wavelengths);
    for (int k = 0; k < 200; ++k) {
      const double cosine = 1e-3 + 0.999 * rng.uniform();
      const FilmPower found = colors.at(cosine);
      FilmPowers expected;
      curves.at(Side::outside, cosine, kAll, expected);
      const Rgb off = found.reflectance - first_three(expected.reflectance),
                off_through = found.transmittance - first_three(expected.transmittance);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(off[c], 0, 2e-9) << name << ", exterior " << material.exterior_ior << ", cosine "
                                     << cosine;
        EXPECT_NEAR(off_through[c], 0, 2e-9) << name << ", cosine " << cosine;
      }
    }
  }
}

TEST(FilmColors, OfTwoHalvesAreThoseOfTheFilm) {
  Material m;
  m.base_ior = 1.4;
  const Wavelengths single = Wavelengths::rgb3(m);
  const FilmColors one(m, single), two(m, test::two_halves(m, single));
  for (const double cosine : {kLeastFilmCosine, 0.01, 0.3, 0.7, 1.0})
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(two.at(cosine).reflectance[c], one.at(cosine).reflectance[c], 1e-12) << cosine;
      EXPECT_NEAR(two.at(cosine).transmittance[c], one.at(cosine).transmittance[c], 1e-12) << cosine;
    }
}

std::string stack(const std::string& lower_layer, const std::string& material, const std::string& more) {
  return "[material]\n" + material +
         "\nfilm_periods = 6\n[[material.film]]\nthickness_nm = 80\nior = 1.56\n[[material.film]]\n"
         "thickness_nm = 90\n" +
         lower_layer + "\n" + more;
}
const std::string kClear = "ior = 2.0", kDark = "ior = 1.7\nextinction = 0.05";

Table film_of(const Recipe& recipe) {
  Table table;
  bake_film(recipe, table);
  return table;
}

// What a smooth layered film does not reflect it lets through only where nothing absorbs.
TEST(FilmArrays, OfSmoothLayeredFilmsHoldWhatPasses) {
  const auto mean_sum = [](const Table& table, double cosine) {
    const std::array x{1020.0, 1.5, cosine};
    return mean(table.film_reflectance.interpolate(x) + table.transmittance(x));
  };
  const Table clear = film_of(parse_recipe(stack(kClear, "roughness = 0\nbase_ior = 1.5", ""), "r")),
              dark = film_of(parse_recipe(stack(kDark, "roughness = 0\nbase_ior = 1.5", ""), "r"));
  for (const double cosine : {0.05, 0.3, 0.7, 1.0}) {
    EXPECT_NEAR(mean_sum(clear, cosine), 1, 1e-6) << cosine;
    EXPECT_LT(mean_sum(dark, cosine), 0.9) << cosine;
    EXPECT_GT(mean(dark.transmittance({1020.0, 1.5, cosine})), 0) << cosine;
  }
  const Table opaque = film_of(parse_recipe(stack(kClear, "roughness = 0\nbase_ior = \"Au\"", ""), "r"));
  ASSERT_FALSE(opaque.film_transmittance.empty());
  for (const float t : opaque.film_transmittance.values()) EXPECT_EQ(t, 0);

  const Table single = film_of(parse_recipe("[material]\nroughness = 0\n", "r"));
  EXPECT_TRUE(single.film_transmittance.empty());
}

// Between nodes, at cosines and thicknesses that choosing them has not looked at, and within 16 MB. The p99
// of the error is relative to the reflectance or 1 %, and chosen to be 0.2 % where the room allows it.
TEST(FilmAxes, ResolveLayeredFilms) {
  const std::string grid = "[grid]\nfilm_thickness_nm = {from = 800, to = 1400, count = 3}\n";
  const std::string two = "[grid]\nfilm_thickness_nm = [900, 1400]\nbase_ior = [1.4, 1.6]\n";
  for (const std::string& text :
       {stack(kClear, "base_ior = 1.5", grid), stack(kClear, "base_ior = 1.5", two),
        stack(kDark, "base_ior = 1.5", grid + "[spectrum]\nmode = \"full\""),
        stack(kDark, "exterior_ior = 1.5\nbase_ior = 1.4", grid), stack(kClear, "base_ior = \"Au\"", grid),
        stack(kClear, "thickness_spread = 0.1", grid)}) {
    const Recipe recipe = parse_recipe(text, "r");
    const Table table = film_of(recipe);
    const std::vector<Axis>& axes = table.film_reflectance.axes();
    EXPECT_LE(table.film_reflectance.cells() * 3 * sizeof(float), 16u << 20) << text;
    std::vector<double> errors;
    Rng rng(2, 0);
    for (int k = 0; k < 200; ++k) {
      Material at = recipe.material;
      at.film_thickness_nm = lerp(rng.uniform(), axes[0].low(), axes[0].high());
      at.base_ior = rng.uniform() < 0.5 ? axes[1].low() : axes[1].high();
      const double cosine = 0.01 + 0.99 * rng.uniform();
      const Rgb exact = FilmColors(at, recipe.spectrum.wavelengths(recipe.material)).at(cosine).reflectance;
      const Rgb off =
          table.film_reflectance.interpolate(std::array{at.film_thickness_nm, at.base_ior, cosine}) - exact;
      errors.push_back(mean_abs(off) / std::max(mean(exact), 0.01));
    }
    std::ranges::sort(errors);
    EXPECT_LT(errors[198], 0.004) << text;
  }
}

// What they were before films had layers.
TEST(FilmAxes, OfSingleFilmsAreFixed) {
  const Recipe recipe = parse_recipe("[grid]\nfilm_thickness_nm = [0, 1000]\n", "r");
  const std::vector<Axis> axes = film_axes(recipe);
  EXPECT_EQ(axes[0].size(), static_cast<std::size_t>(std::ceil(4 * kPi * 1.56 * 1000 / 475 / 0.5)) + 2);
  EXPECT_EQ(axes[1].size(), 1u);
  EXPECT_EQ(axes[2].size(), 65u);
}

}  // namespace
}  // namespace sunbeam
