// What is known exactly of the model, seen through a table.
#include "bake/optics/thin_film.h"
#include "tests/accuracy/support.h"
#include "tests/support/airy_reference.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/quadrature.h"

namespace sunbeam {
namespace {

constexpr double kWavelengths[] = {650, 510, 475};
constexpr double kFilmCosineStep = 1.0 / 64;  // of film_reflectance, see docs/reference/table_format.md

double airy_of(const Material& m, double cosine, int channel) {
  return static_cast<double>(test::airy_reference(m.exterior_ior, m.film_ior, m.base_ior, m.film_thickness_nm,
                                                  cosine, kWavelengths[channel])
                                 .reflectance);
}

// Largest error of interpolating `f` linearly over steps h around x: h^2 / 8 max|f''|, the derivative by
// differences at the nodes' distance, plus 20 % for its own variation, 1e-6 for the files' floats.
template <class F>
double linear_error(F f, double x, double h, double low, double high) {
  const double centre = std::clamp(x, low + 1.5 * h, high - 1.5 * h);
  double second = 0;
  for (int k = -2; k <= 2; ++k) {
    const double at = std::clamp(centre + k * h / 2, low + h / 2, high - h / 2);
    second = std::max(second, std::abs(f(at - h / 2) - 2 * f(at) + f(at + h / 2)) / square(h / 2));
  }
  return 1.2 * square(h) / 8 * second + 1e-6;
}

test::SmallRecipe white_furnace(const std::string& transmission) {
  test::SmallRecipe recipe;
  recipe.transmission = transmission;
  recipe.roughness = 0;
  recipe.absorption_per_nm = 0;
  recipe.albedo = 1;
  return recipe;
}

// Smooth film, no pigment, white base: everything comes back. The remainder is then a constant, so that only
// its noise and the film's interpolation are left: the error of R, at most the bound above, enters R once and
// T T / (1 - rho) once more; the noise at most as Int rest_stderr cos, 4.5 of these.
TEST(TableExact, WhiteFurnace) {
  for (const std::string transmission : {"straight", "refract"}) {
    const Table& table = test::baked(white_furnace(transmission));
    const TableBsdf bsdf = test::bsdf_of(table);
    for (const double cosine : {0.03, 0.2, 0.5, 0.8, 1.0}) {
      const Vec3 wo = direction_from_cosine(cosine, 0);
      const Rgb albedo = bsdf.albedo(wo);
      for (int c = 0; c < 3; ++c) {
        const double noise = 2 * kPi * test::integrate(1e-9, 1, 16, [&](double mu) {
                               return mu * bsdf.rest_stderr(wo, direction_from_cosine(mu, 0))[c];
                             });
        const auto reflectance = [&](double x) { return airy_of(table.material, x, c); };
        const double film = 2 * linear_error(reflectance, cosine, kFilmCosineStep, 1e-9, 1);
        EXPECT_LT(noise, 0.01) << transmission << ' ' << cosine;
        EXPECT_NEAR(albedo[c], 1, 4.5 * noise + film + 5e-4) << transmission << ' ' << cosine;
      }
    }
  }
}

// The film of a smooth table is Airy's reflectance, exact at its nodes, to the interpolation's error between.
TEST(TableExact, DiracWeightIsAiry) {
  for (const std::string transmission : {"straight", "refract"}) {
    test::SmallRecipe recipe = white_furnace(transmission);
    recipe.grid = "film_thickness_nm = [300, 320, 340]";  // the film's own axis is far finer
    const Table& table = test::baked(recipe);
    const Axis& thickness = table.film_reflectance.axes()[0];
    ASSERT_EQ(table.film_reflectance.axes()[2].size(), 65u);
    const double step = thickness.nodes[1] - thickness.nodes[0];
    EXPECT_LE(4 * kPi * 1.56 * step / 475, 0.5);  // radians of film phase
    Rng rng(1, 0);
    for (int k = 0; k < 300; ++k) {
      Material m = table.material;
      m.film_thickness_nm = lerp(rng.uniform(), 300, 340);
      const double cosine = lerp(rng.uniform(), 0.05, 1);
      const TableBsdf bsdf(table, Parameters::of(m));
      for (int c = 0; c < 3; ++c) {
        const auto over_cosine = [&](double x) { return airy_of(m, x, c); };
        const auto over_thickness = [&](double d) {
          Material other = m;
          other.film_thickness_nm = d;
          return airy_of(other, cosine, c);
        };
        const double bound = linear_error(over_cosine, cosine, kFilmCosineStep, 1e-9, 1) +
                             linear_error(over_thickness, m.film_thickness_nm, step, 0, 1000);
        EXPECT_NEAR(bsdf.dirac(direction_from_cosine(cosine, 1))[c], airy_of(m, cosine, c), bound)
            << m.film_thickness_nm << ' ' << cosine;
      }
    }
  }
}

// No film thickness, or a film of either neighbour's index: Fresnel's bare interface at every node.
TEST(TableExact, VanishingFilm) {
  for (const bool rough : {false, true})
    for (int which = 0; which < 3; ++which) {
      test::SmallRecipe recipe;
      recipe.roughness = rough ? 0.3 : 0;
      recipe.albedo = 0;
      if (which == 0) recipe.film_thickness_nm = 0;
      if (which == 1) recipe.film_ior = 1;
      if (which == 2) recipe.film_ior = recipe.base_ior;
      const Table& table = test::baked(recipe);
      for (std::size_t k = 0; k < 65; ++k) {
        const double cosine = static_cast<double>(k) / 64;
        const Rgb found = table.film_reflectance.get(k);
        // The node at the horizon may stand for its limit from above, where R is already below 1.
        const double tolerance = k == 0 ? 1e-5 : 1e-7;
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(found[c], test::fresnel_reference(1, 1.4, cosine), tolerance) << which << ' ' << cosine;
      }
    }
}

// Nothing but air above a diffuse base: Lambert, whatever the mode. The first visit is in closed form and no
// walk adds to it. Cosines below the film's second node are left out: a film at grazing reflects all by
// definition, which interpolation may feel down there, but no further up.
TEST(TableExact, NoInterfaceIsLambert) {
  for (const std::string transmission : {"straight", "refract"}) {
    test::SmallRecipe recipe = white_furnace(transmission);
    recipe.albedo = 0.6;
    recipe.film_ior = recipe.base_ior = 1;
    const TableBsdf bsdf = test::bsdf_of(test::baked(recipe));
    double worst = 0;
    Vec3 where_o, where_i;
    Rng rng(2, 0);
    for (int k = 0; k < 1000; ++k) {
      const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      if (std::min(wo.z, wi.z) < kFilmCosineStep) continue;
      const double error = std::abs(bsdf.eval(wo, wi, rng).g / (0.6 * kInvPi) - 1);
      if (error <= worst) continue;
      worst = error;
      where_o = wo;
      where_i = wi;
    }
    EXPECT_LT(worst, 1e-3) << transmission << ", at cosines " << where_o.z << ' ' << where_i.z;
  }
}

// Index match of a smooth refracting film: n2 = n0, 1.0001 and 1.01 give nearly the same rest. The film is
// there (n1 = 1.56), only bending vanishes: rest changes continuously, here by about (n2 / n0)^2 - 1 = 2 %
// times a factor of order 1.
TEST(TableExact, ContinuousAtIndexMatch) {
  for (const double roughness : {0.0, 0.3}) {
    std::vector<Rgb> albedo;
    for (const double base_ior : {1.0, 1.0001, 1.01}) {
      test::SmallRecipe recipe;
      recipe.roughness = roughness;
      recipe.base_ior = base_ior;
      albedo.push_back(test::bsdf_of(test::baked(recipe)).albedo(spherical_direction(0.6, 0)));
    }
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(albedo[1][c], albedo[0][c], 0.01 * albedo[0][c]) << roughness;
      EXPECT_NEAR(albedo[2][c], albedo[0][c], 0.04 * albedo[0][c]) << roughness;
    }
  }
}

// A black base: no rest at all, bit by bit, and the albedo is the first surface alone.
TEST(TableExact, BlackBase) {
  for (const auto& [name, configuration] : test::configurations()) {
    test::SmallRecipe recipe = configuration;
    recipe.albedo = 0;
    const Table& table = test::baked(recipe);
    const TableBsdf bsdf = test::bsdf_of(table);
    for (const float value : table.remainder.values()) ASSERT_EQ(value, 0) << name;
    for (const float value : table.rest_stderr.values()) ASSERT_EQ(value, 0) << name;
    Rng rng(3, 0);
    for (int k = 0; k < 200; ++k) {
      const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      ASSERT_EQ(bsdf.rest(wo, wi), Rgb(0)) << name;
      ASSERT_EQ(bsdf.eval(wo, wi, rng), bsdf.first(wo, wi)) << name;
    }
  }
}

// Strong pigment leaves nothing of the rest: exp(-3 * 2) or less for every pair of directions.
TEST(TableExact, StrongPigmentIsDark) {
  for (const std::string path : {"sum", "product"}) {
    test::SmallRecipe recipe;
    recipe.path = path;
    recipe.absorption_per_nm = 1.5;
    recipe.transmission = "straight";
    const TableBsdf bsdf = test::bsdf_of(test::baked(recipe));
    // One visit at normal incidence: sum exp(-6), product exp(-3) times kd/pi; T < 1, and later visits are
    // rarer still.
    const double brightest = 0.7 * kInvPi * std::exp(path == "sum" ? -6.0 : -3.0);
    Rng rng(4, 0);
    for (int k = 0; k < 200; ++k) {
      const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      EXPECT_LT(max_component(bsdf.rest(wo, wi)), 1.05 * brightest) << path;
    }
  }
}

// White base, clear pigment, a grid over thickness and base IOR: at random parameters and directions never
// more energy than arrives. 1e-3 for interpolation; an albedo averages 8 cosines and several parameter nodes,
// so that its noise is at most half of a value's, and 3 of these are forgiven.
TEST(TableExact, EnergyIsNeverCreated) {
  for (const double roughness : {0.0, 0.3})
    for (const std::string transmission : {"straight", "refract"}) {
      test::SmallRecipe recipe = white_furnace(transmission);
      recipe.roughness = roughness;
      recipe.noise = roughness == 0 ? 0.01 : 0.02;
      recipe.grid = "film_thickness_nm = [300, 330]\nbase_ior = [1.4, 1.5]";
      const Table& table = test::baked(recipe);
      Rng rng(5, 0);
      for (int k = 0; k < 50; ++k) {
        const Parameters parameters{lerp(rng.uniform(), 300, 330), lerp(rng.uniform(), 1.4, 1.5), 0};
        const TableBsdf bsdf(table, parameters);
        for (int j = 0; j < 5; ++j) {
          const double cosine = lerp(rng.uniform(), 0.02, 1);
          EXPECT_LT(max_component(bsdf.albedo(direction_from_cosine(cosine, 0))),
                    1 + 1e-3 + 1.5 * recipe.noise)
              << transmission << ' ' << roughness << ' ' << cosine << ' ' << parameters.film_thickness_nm;
        }
      }
    }
}

// A base of lower index than the exterior: beyond the critical angle a smooth film lets nothing through, but
// facets of a rough one do. Every value is finite and can be stored as a half.
TEST(TableExact, RarerBaseIsStorable) {
  for (const double absorption : {0.0, 0.01, 0.5})
    for (const double roughness : {0.0, 0.4}) {
      test::SmallRecipe recipe;
      recipe.exterior_ior = 1.5;
      recipe.base_ior = 1.3;
      recipe.roughness = roughness;
      recipe.absorption_per_nm = absorption;
      recipe.albedo = 1;
      recipe.noise = 0.02;
      const Table& table = test::baked(recipe);
      for (const float value : table.remainder.values())
        ASSERT_LT(std::abs(value), 65504) << absorption << ' ' << roughness;  // false for NaN too
    }
}

}  // namespace
}  // namespace sunbeam
