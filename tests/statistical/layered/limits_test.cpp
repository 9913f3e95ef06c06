// Layered films where other films say what they are: equal layers, empty ones, uneven platelets. Fixed seeds;
// the stated rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include <numeric>

#include "bake/live/exact/exact.h"
#include "bake/live/live_bsdf.h"
#include "sunbeam/detail/film_curves.h"
#include "tests/support/estimates.h"
#include "tests/support/layered_materials.h"
#include "tests/support/plain_stack.h"
#include "tests/support/quadrature.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4), kSteep = spherical_direction(0.3, 2.5);

using Layers = std::vector<FilmLayer>;

// Ways to write a single layer of 240 nm and index 1.7.
std::vector<test::LayeredDesign> written_otherwise() {
  return {{"two halves",
           [](double) {
             return Layers{{120, 1.7}, {120, 1.7}};
           }},
          {"six",
           [](double) {
             return Layers{{30, 1.7}, {50, 1.7}};
           },
           3},
          {"and empty ones",
           [](double) {
             return Layers{{0, 2.5}, {240, 1.7}, {0, {1.4, 1}}};
           }},
          {"shares alone",
           [](double) {
             return Layers{{0.5, 1.7}, {1, 1.7}};
           },
           2}};
}

test::Configuration written_as(const test::LayeredDesign& design, const test::NamedMaterial& surface) {
  test::Configuration result = test::with_film(design, surface);
  result.material.film_thickness_nm = 240;
  return result;
}

Material single(Material m) {
  m.film_thickness_nm = 240;
  m.film_ior = 1.7;
  return m;
}

TEST(LayeredLimits, EqualLayersReflectAsOne) {
  for (const auto& surface : test::film_surfaces(Rgb(0.5)))
    for (const auto& design : written_otherwise()) {
      const auto [name, material, wavelengths] = written_as(design, surface);
      const Pfmc one(single(surface.material)), other(material, wavelengths);
      for (const double cosine : {1.0, 0.7, 0.3, 0.05}) {
        const Rgb expected = one.film_reflectance(cosine), found = other.film_reflectance(cosine);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-8) << name << ' ' << cosine;
      }
    }
}

// The single layer by quadrature, the others by walks. 6 surfaces x 4 ways x 2 techniques x 3 channels at 4.5
// standard errors, 1e-3 in all; the quadrature is good to 1e-3 under a liquid (docs/theory/live.md).
TEST(LayeredLimits, WalksThroughEqualLayersAreThoseThroughOne) {
  for (const auto& surface : test::film_surfaces({0.9, 0.8, 0.6}, 0.1)) {
    const Material one = single(surface.material);
    if (!ExactRest::is_valid_for(one)) continue;
    const Rgb expected = ExactRest(one, Wavelengths::rgb3(one)).rest(kOblique, kSteep);
    for (const auto& design : written_otherwise()) {
      const auto [name, material, wavelengths] = written_as(design, surface);
      const Pfmc pfmc(material, wavelengths);
      for (const Technique technique : test::kTechniques) {
        Rng rng(1, 0);
        const auto found = test::mean_rest(pfmc, kOblique, kSteep, technique, {1e-2, 0, 500, 4000}, rng);
        test::expect_agree(found, expected, 4.5, 1e-3, name + ", " + test::name_of(technique));
        EXPECT_LE(found.g.std_error(), 0.05 * expected.g) << name;
      }
    }
  }
}

// Multiple facets have no quadrature: walks through both. 3 surfaces x 3 channels at 4.5 standard errors.
TEST(LayeredLimits, ManyFacetsOfEqualLayersAreThoseOfOne) {
  for (const auto& surface : test::film_surfaces({0.9, 0.8, 0.6}, 0.1)) {
    if (!surface.material.has_multiple_facets()) continue;
    const auto [name, material, wavelengths] = written_as(written_otherwise().front(), surface);
    Rng rng(2, 0);
    const auto run = [&](const Pfmc& pfmc) {
      return test::mean_rest(pfmc, kOblique, kSteep, Technique::unidirectional, {5e-3, 0, 500, 10000}, rng);
    };
    const auto one = run(Pfmc(single(surface.material)));
    const auto other = run(Pfmc(material, wavelengths));
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(test::deviation(one[c].mean(), one[c].std_error(), other[c].mean(), other[c].std_error()),
                4.5)
          << name << ' ' << c;
  }
}

// The mean over the factor on uneven thicknesses, by Simpson's rule.
test::PlainStack::Powers mean_powers(const test::Configuration& c, std::size_t k, bool is_outside,
                                     double cosine) {
  const int steps = c.material.thickness_spread > 0 ? 200 : 0;
  double whole = 0;
  test::PlainStack::Powers sum{0, 0};
  for (int i = 0; i <= steps; ++i) {
    const double z = steps > 0 ? -3 + 6.0 * i / steps : 0;
    const double weight = (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2) * std::exp(-z * z / 2);
    Material even = c.material;
    even.thickness_spread = 0;
    even.film_thickness_nm *= 1 + c.material.thickness_spread * z;
    Rng unused(0, 0);
    const auto power = test::PlainStack(even, c.wavelengths, k).meet(is_outside, cosine, unused);
    whole += weight;
    sum.reflectance += weight * power.reflectance;
    sum.transmittance += weight * power.transmittance;
  }
  return {sum.reflectance / whole, sum.transmittance / whole};
}

// R from both sides and T of what walks look up, at every wavelength and over opaque bases.
TEST(LayeredLimits, PowersAreMeansOverPlatelets) {
  std::vector<test::LayeredDesign> designs = test::clear_designs();
  for (const auto& more : {test::absorbing_designs(), test::opaque_designs()})
    designs.insert(designs.end(), more.begin(), more.end());
  const int numbers[] = {0, 1, 2};
  for (const auto& surface : test::film_surfaces(Rgb(1))) {
    if (!surface.material.is_smooth()) continue;  // facets change nothing
    for (const auto& c : test::with_films(designs, {surface})) {
      const FilmCurves curves(c.material, c.wavelengths);
      for (const bool is_outside : {true, false})
        for (const double cosine : {1.0, 0.8, 0.5, 0.2}) {
          if (!is_outside && c.material.is_opaque()) continue;
          FilmPowers found;
          curves.at(is_outside ? sunbeam::Side::outside : sunbeam::Side::inside, cosine, numbers, found);
          for (std::size_t k = 0; k < 3; ++k) {
            const auto [r, t] = mean_powers(c, k, is_outside, cosine);
            EXPECT_NEAR(found.reflectance[k], r, 1e-7) << c.name << ' ' << cosine << ' ' << k;
            EXPECT_NEAR(found.transmittance[k], c.material.is_opaque() ? 0 : t, 1e-7) << c.name << ' ' << k;
          }
        }
    }
  }
}

// Fringes over the wavelength fade with the spread, and their mean stays.
TEST(LayeredLimits, FringesFadeWithSpread) {
  const auto reflectances = [](double spread) {
    Material m;
    m.roughness = 0;
    m.film_thickness_nm = 2000;
    m.film_ior = 1.8;
    m.thickness_spread = spread;
    Wavelengths w = Wavelengths::rgb3(m);
    std::vector<double> result;
    for (double nm = 500; nm < 600; nm += 5) {
      w.nm = {nm, nm, nm};
      result.push_back(Pfmc(m, w).film_reflectance(0.8).g);
    }
    return result;
  };
  const auto mean_of = [](const std::vector<double>& x) {
    return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  };
  const auto contrast_of = [](const std::vector<double>& x) {
    const auto [least, most] = std::ranges::minmax(x);
    return (most - least) / (most + least);
  };
  const auto even = reflectances(0);
  double last = contrast_of(even);
  EXPECT_GT(last, 0.5);
  for (const double spread : {0.02, 0.05, 0.1, 0.2}) {
    const auto uneven = reflectances(spread);
    EXPECT_LT(contrast_of(uneven), 0.8 * last) << spread;
    EXPECT_NEAR(mean_of(uneven), mean_of(even), 0.1 * mean_of(even)) << spread;
    last = contrast_of(uneven);
  }
  EXPECT_LT(last, 0.02);
}

}  // namespace
}  // namespace sunbeam
