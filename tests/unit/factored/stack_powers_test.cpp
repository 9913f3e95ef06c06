// Layered films over fringe orders against their closed form, and the nodes that tables take for them.
#include "bake/factored/orders/stack_powers.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>

#include "bake/factored/axes.h"
#include "bake/factored/orders/exchange_axes.h"
#include "bake/optics/thin_film.h"
#include "sunbeam/detail/film_curves.h"
#include "tests/support/layered_films.h"

namespace sunbeam {
namespace {

constexpr double kNm = 510;

Wavelengths one_of(const test::LayeredFilm& design, std::size_t k) {
  Wavelengths one = Wavelengths::monochromatic(design.material, design.wavelengths.nm[k]);
  if (!design.wavelengths.layers.empty()) one.layers = {design.wavelengths.layers[k]};
  if (!design.wavelengths.base_index.empty()) one.base_index = {design.wavelengths.base_index[k]};
  one.film_periods = design.wavelengths.film_periods;
  return one;
}

// A film whose thickness makes the order at its wavelength has the powers of the order there. The nodes over
// the cosine are as good as straight lines get.
TEST(StackPowers, AreThoseOfTheFilmAtTheOrder) {
  Material material;
  material.base_ior = 1.4;
  for (auto design : test::layered_films(material)) {
    const Wavelengths one = one_of(design, 1);
    const double order =
        path_per_thickness(design.material, one, 0) * design.material.film_thickness_nm / kNm;
    const std::array orders{0.0, order, order + 0.5};
    const FilmCurves film(design.material, one);
    for (const Side side : {Side::outside, Side::inside}) {
      const StackPowers stack(design.material, one, side, orders);
      for (const double cosine : {0.05, 0.3, 0.71, 0.9, 1.0}) {
        std::array<double, 3> reflectance, transmittance;
        stack.at(cosine, reflectance, transmittance);
        FilmPowers expected;
        const int first = 0;
        film.at(side, cosine, std::span(&first, 1), expected);
        EXPECT_NEAR(reflectance[1], expected.reflectance[0], 2e-3) << design.name << ' ' << cosine;
        EXPECT_NEAR(transmittance[1], expected.transmittance[0], 2e-3) << design.name << ' ' << cosine;
      }
    }
  }
}

TEST(StackPowers, EqualLayersAreOneFilm) {
  for (const auto transmission : {Transmission::straight, Transmission::refract}) {
    Material material;
    material.transmission = transmission;
    material.base_ior = 1.4;
    Wavelengths one = Wavelengths::monochromatic(material, kNm);
    one.layers = {{{1, material.film_ior}, {3, material.film_ior}}};
    const std::array orders{0.0, 0.7, 4.2};
    for (const Side side : {Side::outside, Side::inside}) {
      const StackPowers stack(material, one, side, orders);
      for (const double cosine : {0.0, 0.2, 0.6, 0.85, 1.0}) {
        std::array<double, 3> reflectance, transmittance;
        stack.at(cosine, reflectance, transmittance);
        for (std::size_t j = 0; j < orders.size(); ++j) {
          ThinFilm film = side == Side::outside ? ThinFilm::of(material) : ThinFilm::below(material);
          film.thickness_nm = orders[j] / (2 * material.film_ior);
          const FilmPower expected = airy(film, cosine, Rgb(1));
          EXPECT_NEAR(reflectance[j], expected.reflectance.r, 1e-4) << cosine << ' ' << orders[j];
          EXPECT_NEAR(transmittance[j], expected.transmittance.r, 1e-4) << cosine << ' ' << orders[j];
        }
      }
    }
  }
}

std::string recipe_text(const std::string& albedo, const std::string& high_ior) {
  return "[material]\nabsorption_path = \"product\"\nbase_ior = 1.5\nalbedo = " + albedo +
         "\nfilm_periods = 5\n[[material.film]]\nthickness_nm = 60\nior = " + high_ior +
         "\n[[material.film]]\nthickness_nm = 90\nior = 1.46\n[table]\nencoding = \"factored\"\n"
         "[grid]\nfilm_thickness_nm = [400.0, 1000.0]\n";
}

std::map<std::string, std::size_t> nodes_of(const std::string& albedo, const std::string& high_ior) {
  const Recipe recipe = parse_recipe(recipe_text(albedo, high_ior), "mirror.toml");
  std::map<std::string, std::size_t> nodes;
  const ArrayShape exchange = factor_shapes(recipe).exchange;
  for (const Axis& axis : exchange.axes()) nodes[axis.name] = axis.size();
  return nodes;
}

// The brighter the base, the more the edges of a mirror tell; the nodes over the wavelength are for indices
// that depend on it.
TEST(ExchangeAxes, AskForNodesWhereTheyTell) {
  const std::string dispersive = "{cauchy = [2.2, 5e4]}";
  auto dark = nodes_of("[0.02, 0.05, 0.1]", "2.4"), bright = nodes_of("[0.5, 0.7, 0.95]", "2.4");
  EXPECT_GT(bright["fringe_order"], 2 * dark["fringe_order"]);
  EXPECT_GT(bright["albedo"], dark["albedo"]);
  EXPECT_EQ(dark["albedo"], 3u);
  EXPECT_EQ(dark["wavelength_nm"], 1u);
  EXPECT_GT(nodes_of("0.3", dispersive)["wavelength_nm"], 1u);
  EXPECT_GE(nodes_of("0.95", dispersive)["wavelength_nm"], nodes_of("0.3", dispersive)["wavelength_nm"]);
  EXPECT_EQ(nodes_of("0.3", dispersive)["albedo"], 1u);
}

}  // namespace
}  // namespace sunbeam
