// The powers of layered films over the cosine against their closed form from either side.
#include "sunbeam/detail/film_curves.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bake/optics/thin_film.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/quadrature.h"
#include "tests/support/layered_films.h"

namespace sunbeam {
namespace {

constexpr double kError = 1e-10;  // that the header states
constexpr std::array kAll{0, 1, 2};

// Written anew: the whole stack at one wavelength, its thicknesses times a factor.
FilmStack stack_of(const test::LayeredFilm& design, std::size_t k, double factor = 1) {
  const Material& m = design.material;
  const Wavelengths& w = design.wavelengths;
  FilmStack stack{m.exterior_ior, {}, {m.base_ior, m.base_extinction}};
  if (!w.base_index.empty()) stack.base_index = w.base_index[k];
  for (int period = 0; period < w.film_periods; ++period)
    for (FilmLayer layer : w.layers[k]) {
      layer.thickness_nm *= factor;
      stack.layers.push_back(layer);
    }
  return stack;
}

FilmStack reversed(const FilmStack& stack) {
  return {stack.base_index.real(), {stack.layers.rbegin(), stack.layers.rend()}, stack.exterior_ior};
}

struct Powers {
  double reflectance, transmittance, reverse;
};

// Of light whose direction outside has this cosine, on either side.
Powers passing(const FilmStack& stack, Side side, double cos_outside, double nm) {
  const StackPower power = stack_power(stack, cos_outside, nm);
  const double below = reflectance_below(stack, cos_outside, nm).value_or(power.reflectance);
  if (side == Side::outside) return {power.reflectance, power.transmittance, below};
  return {below, power.transmittance, power.reflectance};
}

// A normal factor on all thicknesses, cut at three deviations, by Simpson's rule.
Powers mean_passing(const test::LayeredFilm& design, std::size_t k, Side side, double cos_outside) {
  constexpr int kSteps = 3000;
  Powers sum{};
  double weights = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double z = 6.0 * i / kSteps - 3;
    const double weight = std::exp(-z * z / 2) * (i == 0 || i == kSteps ? 1 : i % 2 == 0 ? 2 : 4);
    const auto at = passing(stack_of(design, k, 1 + z * design.material.thickness_spread), side, cos_outside,
                            design.wavelengths.nm[k]);
    sum.reflectance += weight * at.reflectance;
    sum.transmittance += weight * at.transmittance;
    sum.reverse += weight * at.reverse;
    weights += weight;
  }
  return {sum.reflectance / weights, sum.transmittance / weights, sum.reverse / weights};
}

void expect_powers(const FilmCurves& curves, Side side, double cosine, std::size_t k, const Powers& expected,
                   const std::string& what) {
  FilmPowers found;
  curves.at(side, cosine, kAll, found);
  EXPECT_NEAR(found.reflectance[k], expected.reflectance, kError) << what << ' ' << cosine;
  EXPECT_NEAR(found.transmittance[k], expected.transmittance, kError) << what << ' ' << cosine;
  EXPECT_NEAR(found.reverse[k], expected.reverse, kError) << what << ' ' << cosine;
}

// Evenly, and many near grazing.
double cosine_from(Rng& rng) {
  return rng.uniform() < 0.5 ? lerp(rng.uniform(), 0.002, 1) : std::pow(10, -2.5 * rng.uniform());
}

// Base denser, rarer, and equal.
std::vector<Material> media(Transmission transmission) {
  Material denser, rarer, equal;
  denser.base_ior = 1.5;
  rarer.exterior_ior = 1.5;
  rarer.base_ior = 1.33;
  equal.exterior_ior = equal.base_ior = 1.33;
  std::vector<Material> all{denser, rarer, equal};
  for (Material& m : all) m.transmission = transmission;
  return all;
}

// Calls visit(design, curves, cosine, k) at random cosines and wavelengths of all films without spread.
template <class Visit>
void each_film(Transmission transmission, Rng& rng, Visit visit) {
  for (const Material& material : media(transmission))
    for (const auto& design : test::layered_films(material)) {
      if (design.material.thickness_spread > 0) continue;
      const FilmCurves curves(design.material, design.wavelengths);
      for (int i = 0; i < 300; ++i) visit(design, curves, cosine_from(rng), static_cast<std::size_t>(i % 3));
    }
}

TEST(FilmCurves, AreTheClosedFormFromOutside) {
  Rng rng(1, 0);
  for (const Transmission transmission : {Transmission::refract, Transmission::straight})
    each_film(transmission, rng, [](const auto& design, const auto& curves, double cosine, std::size_t k) {
      const Material& material = design.material;
      Powers expected = passing(stack_of(design, k), Side::outside, cosine, design.wavelengths.nm[k]);
      // Beyond the angle at which base_ior reflects totally nothing passes at any wavelength.
      if (refracted_cosine_squared(material.exterior_ior, material.base_ior, cosine) <= 0)
        expected = {expected.reflectance + expected.transmittance, 0,
                    expected.reflectance + expected.transmittance};
      expect_powers(curves, Side::outside, cosine, k, expected, design.name);
    });
}

TEST(FilmCurves, AreTheReversedStackFromBelow) {
  Rng rng(2, 0);
  int total = 0;
  each_film(
      Transmission::refract, rng, [&](const auto& design, const auto& curves, double cosine, std::size_t k) {
        const Material& material = design.material;
        const FilmStack stack = stack_of(design, k);
        const double nm = design.wavelengths.nm[k];
        const double outside2 = refracted_cosine_squared(material.base_ior, material.exterior_ior, cosine);
        if (outside2 > 1e-6) {
          expect_powers(curves, Side::inside, cosine, k,
                        passing(stack, Side::inside, std::sqrt(outside2), nm), design.name);
        } else if (outside2 <= 0 && design.wavelengths.base_index.empty()) {
          const double r = stack_power(reversed(stack), cosine, nm).reflectance;
          expect_powers(curves, Side::inside, cosine, k, {r, 0, r}, design.name + " totally");
          ++total;
        }
      });
  EXPECT_GT(total, 300);
}

// Light does not bend: the cosine below is that outside.
TEST(FilmCurves, StraightLightFromBelowMeetsTheReversedStackAtTheSameAngle) {
  Rng rng(3, 0);
  each_film(Transmission::straight, rng,
            [](const auto& design, const auto& curves, double cosine, std::size_t k) {
              const Material& material = design.material;
              if (refracted_cosine_squared(material.exterior_ior, material.base_ior - 0.02, cosine) < 1e-5)
                return;
              expect_powers(curves, Side::inside, cosine, k,
                            passing(stack_of(design, k), Side::inside, cosine, design.wavelengths.nm[k]),
                            design.name);
            });
}

// Where what is above reflects totally and layers absorb, less than all comes back.
TEST(FilmCurves, TotalReflectionLosesWhatLayersAbsorb) {
  Material material;
  material.exterior_ior = 1.5;
  material.base_ior = 1.33;
  const auto design = test::beetle(material);
  FilmPowers powers;
  FilmCurves(design.material, design.wavelengths).at(Side::outside, 0.3, kAll, powers);
  for (const std::size_t k : {0, 1, 2}) {
    EXPECT_LT(powers.reflectance[k], 0.95);
    EXPECT_EQ(powers.transmittance[k], 0);
  }
}

TEST(FilmCurves, NothingPassesIntoAnOpaqueBase) {
  Rng rng(4, 0);
  for (const double exterior_ior : {1.0, 1.33}) {
    Material material;
    material.exterior_ior = exterior_ior;
    const auto design = test::opaque(material);
    const FilmCurves curves(design.material, design.wavelengths);
    for (int i = 0; i < 300; ++i) {
      const double cosine = cosine_from(rng);
      const std::size_t k = i % 3;
      const double r = stack_power(stack_of(design, k), cosine, design.wavelengths.nm[k]).reflectance;
      expect_powers(curves, Side::outside, cosine, k, {r, 0, r}, design.name);
      FilmPowers powers;
      curves.at(Side::outside, cosine, kAll, powers);
      EXPECT_EQ(powers.transmittance[k], 0);
    }
  }
}

TEST(FilmCurves, UnevenPlateletsHaveTheMean) {
  for (const Material& material : media(Transmission::refract)) {
    const auto design = test::uneven_platelets(material);
    const FilmCurves curves(design.material, design.wavelengths);
    for (const double cosine : {1.0, 0.8, 0.5}) {
      for (const std::size_t k : {0, 2})
        expect_powers(curves, Side::outside, cosine, k, mean_passing(design, k, Side::outside, cosine),
                      design.name);
    }
  }
}

TEST(FilmCurves, ClearFilmsKeepAllPower) {
  Rng rng(5, 0);
  for (const Transmission transmission : {Transmission::refract, Transmission::straight})
    for (const Material& material : media(transmission))
      for (const auto& design : {test::clear_mirror(material), test::butterfly(material)}) {
        const FilmCurves curves(design.material, design.wavelengths);
        for (int i = 0; i < 300; ++i) {
          FilmPowers powers;
          curves.at(i % 2 == 0 ? Side::outside : Side::inside, cosine_from(rng), kAll, powers);
          for (const std::size_t k : {0, 1, 2})
            EXPECT_NEAR(powers.reflectance[k] + powers.transmittance[k], 1, 1e-12) << design.name;
        }
      }
}

TEST(FilmCurves, WavelengthsArePickedByNumber) {
  const auto design = test::beetle(Material());
  const FilmCurves curves(design.material, design.wavelengths);
  FilmPowers all, some;
  curves.at(Side::inside, 0.7, kAll, all);
  curves.at(Side::inside, 0.7, std::array{2, 0}, some);
  for (const auto numbers : {&FilmPowers::reflectance, &FilmPowers::transmittance, &FilmPowers::reverse}) {
    EXPECT_EQ((some.*numbers)[0], (all.*numbers)[2]);
    EXPECT_EQ((some.*numbers)[1], (all.*numbers)[0]);
  }
}

// Gauss' rule between the edges resolves the powers, however narrow their resonances.
TEST(FilmCurves, EdgesDivideWherePowersAreSmooth) {
  const GaussRule few = gauss_legendre(8), many = gauss_legendre(60);
  for (const Material& material : media(Transmission::refract))
    for (const auto& design : test::layered_films(material))
      for (const Side side : {Side::outside, Side::inside}) {
        const FilmCurves curves(design.material, design.wavelengths);
        const std::vector<double> edges = curves.edges(side);
        ASSERT_TRUE(std::ranges::is_sorted(edges));
        EXPECT_EQ(edges.front(), 0);
        EXPECT_EQ(edges.back(), 1);
        for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
          const auto mean = [&](const GaussRule& rule) {
            double sum = 0;
            FilmPowers powers;
            for (int i = 0; i < rule.size(); ++i) {
              const double t = rule.node[i], flat = t * t * (3 - 2 * t);
              curves.at(side, lerp(flat, edges[p], edges[p + 1]), kAll, powers);
              sum += rule.weight[i] * powers.reflectance[1];
            }
            return sum;
          };
          EXPECT_NEAR(mean(few), mean(many), 1e-7) << design.name << ' ' << edges[p];
        }
      }
}

TEST(FilmCurves, ServeAllButOneClearLayer) {
  const Material single;
  Material opaque = single, uneven = single;
  opaque.base_extinction = 1;
  uneven.thickness_spread = 0.1;
  const Wavelengths plain = Wavelengths::rgb3(single);
  Wavelengths base = plain;
  base.base_index.assign(3, 1.4);
  EXPECT_FALSE(is_layered(single, plain));
  EXPECT_TRUE(is_layered(opaque, plain));
  EXPECT_TRUE(is_layered(uneven, plain));
  EXPECT_TRUE(is_layered(single, base));
  EXPECT_TRUE(is_layered(single, test::two_halves(single, plain)));
}

}  // namespace
}  // namespace sunbeam
