// The yardstick of scattering slabs by itself: against adding and doubling where there is no film, against
// the exact evaluator where nothing scatters. Fixed seeds; the stated rates of false alarm hold when a seed
// is changed.
#include "tests/support/plain_slab.h"

#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "tests/support/adding_doubling.h"
#include "tests/support/materials.h"

namespace sunbeam {
namespace {

const Rgb kNm(650, 510, 475);

// Mean of cos^k of the angle is g for k = 1, and (1 + 2 g^2) / 3 for k = 2; about both axes evenly. 5 x 5
// tests at 4.5 standard errors: 2e-4.
TEST(PlainSlab, PhaseFunctionHasItsMoments) {
  const Vec3 travel = normalize({0.3, -0.5, -0.4});
  const Vec3 x = normalize(cross({0, 0, 1}, travel)), y = cross(travel, x);
  for (const double g : {-0.7, 0.0, 0.3, 0.9, 0.99}) {
    Rng rng(1, 0);
    test::RunningMean first, second, right, up, both;
    for (int i = 0; i < 200000; ++i) {
      const Vec3 w = test::scatter(travel, g, rng);
      first.add(dot(w, travel));
      second.add(square(dot(w, travel)));
      right.add(dot(w, x));
      up.add(dot(w, y));
      both.add(square(dot(w, x)) - square(dot(w, y)));
    }
    EXPECT_NEAR(first.mean(), g, 4.5 * first.std_error()) << g;
    EXPECT_NEAR(second.mean(), (1 + 2 * g * g) / 3, 4.5 * second.std_error()) << g;
    for (const auto* sideways : {&right, &up, &both})
      EXPECT_NEAR(sideways->mean(), 0, 4.5 * sideways->std_error()) << g;
  }
}

// Index matched on both sides: there is no film.
Material bare(double scattering, double absorption, double g, const Rgb& albedo) {
  Material m;
  m.film_thickness_nm = 0;
  m.exterior_ior = m.film_ior = m.base_ior = 1;
  m.roughness = 0;
  m.pigment_thickness_nm = 1;
  m.scattering_per_nm = scattering;
  m.absorption_per_nm = absorption;
  m.anisotropy = g;
  m.albedo = albedo;
  return m;
}

// Black, grey and white base in one walk's three channels. 18 slabs x 2 angles x 3 at 4.5 standard errors:
// 7e-4. The yardsticks know a slab to 1e-5 and 0.3 %.
TEST(PlainSlab, AgreesWithAddingDoubling) {
  const Rgb base(0, 0.5, 1);
  for (const double thickness : {0.1, 1.0, 5.0})
    for (const double g : {0.0, 0.5, 0.9})
      for (const double albedo : {0.6, 1.0}) {
        const test::AddingDoubling exact(thickness, albedo, g, {0.3, 0.9});
        const Material m = bare(thickness * albedo, thickness * (1 - albedo), g, base);
        const test::PlainSlab plain(m, kNm);
        for (std::size_t k = 0; k < 2; ++k) {
          Rng rng(2, k);
          const Vec3 wi = spherical_direction(std::acos(k == 0 ? 0.3 : 0.9), 0.4);
          const auto found = plain.albedo(wi, 20000, rng);
          for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found[c].mean(), exact.reflectance_over(base[c], k),
                        4.5 * found[c].std_error() + 1e-5)
                << thickness << ' ' << g << ' ' << albedo << ' ' << k << " base " << base[c];
            EXPECT_LT(found[c].std_error(), 4e-3);
          }
        }
      }
}

// Without scattering the base alone counts. 4 films x (3 channels of a histogram, 3 albedos): 24 tests, 1e-3.
TEST(PlainSlab, AgreesWithTheExactEvaluatorWithoutScattering) {
  const Vec3 wi = spherical_direction(0.8, 0.3);
  const test::CellGrid grid;
  for (const auto& [name, material] : test::all_modes()) {
    if (material.absorption_path == AbsorptionPath::product) continue;
    const ExactRest exact(material, Wavelengths::rgb3(material));
    Rng rng(3, 0);
    const auto found = test::PlainSlab(material, kNm).histogram(wi, grid, 200000, rng).cells();
    const auto expected =
        test::integrate_cells(grid, 64, rng, [&](const Vec3& wo, Rng&) { return exact.rest(wo, wi) * wo.z; });
    EXPECT_GT(test::least_p_value(found, expected), test::sidak(1e-3, 24)) << name;
    const test::RgbMean albedo = test::PlainSlab(material, kNm).albedo(wi, 100000, rng);
    const Rgb whole = exact.albedo(wi);
    test::RgbMean first;
    const test::PlainFilm film(material, kNm);
    for (int i = 0; i < 100000; ++i) first.add(film.reflected(wi, rng));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(albedo[c].mean() + first[c].mean(), whole[c],
                  4.5 * std::hypot(albedo[c].std_error(), first[c].std_error()) + 1e-4 * whole[c])
          << name;
  }
}

}  // namespace
}  // namespace sunbeam
