// What tables say of each wavelength of a layered film, against the exact evaluator: what passes the film,
// what it returns to the base and what it reflects.
#include "runtime/src/layers/layered_waves.h"

#include <gtest/gtest.h>

#include <array>

#include "bake/jobs/bake.h"
#include "bake/live/exact/exact.h"

namespace sunbeam {
namespace {

// Lines of a recipe.
struct Film {
  std::string name, layers, base = "base_ior = 1.5\n";
};
struct Surface {
  std::string name, lines;
};
struct Case {
  Film film;
  Surface surface;
  std::string spectrum = "mode = \"rgb3\"";

  friend void PrintTo(const Case& one, std::ostream* out) {
    *out << one.film.name << " " << one.surface.name;
  }
};

std::string layer(const std::string& thickness_nm, const std::string& index) {
  return "[[material.film]]\nthickness_nm = " + thickness_nm + "\nior = " + index + "\n";
}

const std::string kDark = layer("40", "1.9\nextinction = 0.5"), kLeaf = layer("14", "0.3\nextinction = 3");
const std::string kHigh = layer("60", "2.2"), kLow = layer("90", "1.4");
const std::string kDispersive = layer("80", "{cauchy = [1.7, 2e4]}"), kWater = layer("110", "\"water\"");

// Each is wrong somewhere if it is taken for less than it is: of a leaf R from above, R from below and 1 - T
// are three things.
std::vector<Film> films() {
  return {{"leaf", kDark + kLeaf},
          {"leaf_upside_down", kLeaf + kDark},
          {"mirror", "film_periods = 4\n" + kHigh + kLow},
          {"uneven", "film_periods = 2\nthickness_spread = 0.15\n" + kHigh + kDark},
          {"dispersive", "film_periods = 2\n" + kDispersive + kWater, "base_ior = {cauchy = [1.45, 8e3]}\n"}};
}

// Under a liquid light is reflected totally from outside.
std::vector<Surface> surfaces() {
  return {{"smooth", "roughness = 0\n"},
          {"smooth_straight", "roughness = 0\ntransmission = \"straight\"\n"},
          {"rough", "roughness = 0.3\n"},
          {"rough_straight", "roughness = 0.3\ntransmission = \"straight\"\n"},
          {"smooth_under_liquid", "roughness = 0\nexterior_ior = 1.7\n"},
          {"rough_under_liquid", "roughness = 0.2\nexterior_ior = 1.7\n"}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const Film& film : films())
    for (const Surface& surface : surfaces()) result.push_back({film, surface});
  result.push_back({films()[0], {"anisotropic", "roughness = [0.2, 0.4]\n"}});
  result.push_back({films()[3],
                    {"rough_full", surfaces()[2].lines + "absorption_spectrum = \"eumelanin\"\n"},
                    "mode = \"full\""});
  return result;
}

Recipe recipe_of(const Case& one) {
  return parse_recipe("[material]\nabsorption_per_nm = 0.15\npigment_thickness_nm = 2\nalbedo = 0.8\n" +
                          one.surface.lines + one.film.base + one.film.layers + "[spectrum]\n" +
                          one.spectrum + "\n[table]\nencoding = \"factored\"\n",
                      "waves.toml");
}

constexpr double kTolerance = 3e-3;

// Normal incidence, and others, of which the last is reflected totally under the liquid.
std::vector<Vec3> directions() {
  return {spherical_direction(0.05, 0.3), spherical_direction(0.6, 0.3), spherical_direction(0.9, 1.2),
          spherical_direction(1.3, 0.8)};
}

void expect_arriving(const LayeredWaves& waves, const ExactRest& exact, double depth) {
  for (const Vec3& w : directions()) {
    std::vector<double> share(waves.size());
    waves.arriving(waves.passage(w.z, azimuth(w)), depth, share);
    const std::vector<double> expected = exact.arriving(w);
    for (std::size_t k = 0; k < waves.size(); ++k)
      EXPECT_NEAR(share[k], expected[k], kTolerance * expected[k] + 1e-5) << w.z << ' ' << k;
  }
}

// From gain = s kd/pi / (1 - kd returned).
void expect_returned(const LayeredWaves& waves, const ExactRest& exact, const Material& material) {
  const std::vector<double> gain = exact.gain();
  for (std::size_t k = 0; k < waves.size(); ++k) {
    const double kd = exact.wavelengths().albedo[k];
    const double expected = (1 - material.radiance_scale() * kd / (kPi * gain[k])) / kd;
    EXPECT_NEAR(waves.returned(k, material.optical_depth()), expected, kTolerance * expected) << k;
  }
}

void expect_reflectance(const LayeredWaves& waves, const ExactRest& exact) {
  for (const double cosine : {0.1, 0.5, 0.8, 1.0}) {
    const Rgb expected = exact.wavelengths().fold(exact.facet_reflectance(cosine));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(waves.reflectance(cosine)[c], expected[c], 1e-4) << cosine;
  }
}

void expect_waves(const Table& table, const Material& material, const ExactRest& exact) {
  const LayeredWaves waves(table, material);
  expect_reflectance(waves, exact);
  expect_arriving(waves, exact, material.optical_depth());
  expect_returned(waves, exact, material);
}

Table baked(const Recipe& recipe) { return bake_table(recipe, {.seed = 1, .threads = 0, .on_progress = {}}); }

class LayeredTableWaves : public ::testing::TestWithParam<Case> {};

TEST_P(LayeredTableWaves, AreThoseOfTheExactEvaluator) {
  const Recipe recipe = recipe_of(GetParam());
  const Material& material = recipe.material;
  expect_waves(baked(recipe), material, ExactRest(material, recipe.spectrum.wavelengths(material)));
}

INSTANTIATE_TEST_SUITE_P(, LayeredTableWaves, ::testing::ValuesIn(cases()), [](const auto& info) {
  return info.param.film.name + "_" + info.param.surface.name;
});

// Under a liquid A falls steeply about the critical angle, where nodes of theta are as far apart as it is
// wide.
TEST(LayeredTableWavesUnderLiquid, HoldAboutTheCriticalAngle) {
  for (const std::string roughness : {"0.05", "0.2"}) {
    const Recipe recipe =
        recipe_of({films()[2], {"", "exterior_ior = 1.7\nroughness = " + roughness + "\n"}});
    const Material& material = recipe.material;
    const Table table = baked(recipe);
    const LayeredWaves waves(table, material);
    const ExactRest exact(material, recipe.spectrum.wavelengths(material));
    for (double cosine = 0.3; cosine < 0.7; cosine += 0.01) {
      std::vector<double> share(waves.size());
      waves.arriving(waves.passage(cosine, 0), material.optical_depth(), share);
      const std::vector<double> expected = exact.arriving(direction_from_cosine(cosine, 0));
      for (std::size_t k = 0; k < waves.size(); ++k) EXPECT_NEAR(share[k], expected[k], 0.015) << cosine;
    }
  }
}

// Three layers of one index are a film that Airy's formula serves.
TEST(LayeredTableWavesOfOneFilm, AreThoseOfAiry) {
  for (const Surface& surface : surfaces()) {
    SCOPED_TRACE(surface.name);
    const std::string equal = layer("150", "1.56") + layer("100", "1.56") + layer("200", "1.56");
    const Recipe layers = recipe_of({{"equal", equal}, surface});
    const Recipe single = recipe_of({{"single", "film_thickness_nm = 450\nfilm_ior = 1.56\n"}, surface});
    const Wavelengths wavelengths = single.spectrum.wavelengths(single.material);
    ASSERT_FALSE(is_layered(single.material, wavelengths));
    expect_waves(baked(layers), layers.material, ExactRest(single.material, wavelengths));
  }
}

}  // namespace
}  // namespace sunbeam
