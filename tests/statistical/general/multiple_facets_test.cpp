// The live model of facets that pass light on to each other against the plain walk over a microsurface
// (plain_microsurface.h), and where the answer is known. Fixed seeds; the stated rates of false alarm hold
// when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "bake/live/live_bsdf.h"
#include "tests/support/configurations.h"
#include "tests/support/estimates.h"
#include "tests/support/plain_microsurface.h"

namespace sunbeam {
namespace {

using test::kTechniques;
using test::name_of;

const Rgb kNm(650, 510, 475);
constexpr Transmission kTransmissions[] = {Transmission::straight, Transmission::refract};

Material facets(const Roughness& roughness, Transmission transmission, const Rgb& albedo,
                double base_ior = 1.5) {
  Material m;
  m.transmission = transmission;
  m.film_thickness_nm = 350;
  m.base_ior = base_ior;
  m.absorption_per_nm = 0;
  m.albedo = albedo;
  m.roughness = roughness;
  m.microfacet = Microfacet::multiple;
  return m;
}

std::string describe(const Material& m) {
  return to_string(m.roughness) + " " + std::string(to_string(m.transmission)) + " base " +
         std::to_string(m.base_ior);
}

// What the film's upper surface reflects at once, by drawing its normals.
test::RgbMean first_albedo(const Material& m, const Vec3& wo, Rng& rng) {
  const test::PlainFilm film(m, kNm);
  return test::until_known({2e-4, 1e-4, 10000, 500000}, [&] { return film.reflected(wo, rng); });
}

// White base, no absorption: all light comes back. 5 roughnesses x 2 modes x 2 bases x 3 angles at 4.5
// standard errors, 4e-4 in all; their mean to 0.1 %.
TEST(MultipleFacets, FurnaceBySampling) {
  test::RunningMean all;
  double variance = 0;
  for (const double roughness : {0.05, 0.1, 0.3, 0.6, 1.0})
    for (const auto transmission : kTransmissions)
      for (const double base_ior : {1.0, 1.5})
        for (const double theta : {0.0, 0.8, 1.4}) {
          const Material m = facets(roughness, transmission, Rgb(1), base_ior);
          Rng rng(1, 0);
          const auto found =
              test::sampled_albedo(LiveBsdf(m, Wavelengths::monochromatic(m, 550)),
                                   spherical_direction(theta, 0.4), {2e-4, 0, 2000, 30000}, rng);
          EXPECT_NEAR(found.g.mean(), 1, 4.5 * found.g.std_error() + 1e-9) << describe(m) << ' ' << theta;
          EXPECT_LE(found.g.std_error(), 5e-3) << describe(m) << ' ' << theta;
          all.add(found.g.mean());
          variance += square(found.g.std_error());
        }
  EXPECT_NEAR(all.mean(), 1, 1e-3);
  EXPECT_LE(std::sqrt(variance) / 60, 2.5e-4);
}

// The same through eval(): its first surface by drawing normals, its rest by integration. 3 roughnesses x 2
// modes x 2 bases x 2 techniques x 3 channels at 4.5 standard errors, 5e-4 in all; their mean to 0.1 %.
TEST(MultipleFacets, FurnaceByIntegration) {
  const Vec3 wo = spherical_direction(0.8, 0.4);
  Rgb sum, variance;
  for (const double roughness : {0.1, 0.4, 1.0})
    for (const auto transmission : kTransmissions)
      for (const double base_ior : {1.0, 1.5}) {
        const Material m = facets(roughness, transmission, Rgb(1), base_ior);
        const Pfmc pfmc(m);
        Rng rng(2, 0);
        const auto first = first_albedo(m, wo, rng);
        for (const Technique technique : kTechniques) {
          test::RgbMean rest;
          for (const Rgb& total : test::integrate_stratified(12, 24, rng, [&](const Vec3&wi, Rng&r) {
                 return pfmc.estimate_rest(wo, wi, r, technique) * wi.z;
               }))
            rest.add(total);
          for (int c = 0; c < 3; ++c) {
            const double error = std::hypot(first[c].std_error(), rest[c].std_error());
            EXPECT_NEAR(first[c].mean() + rest[c].mean(), 1, 4.5 * error)
                << describe(m) << ", " << name_of(technique) << ", channel " << c;
            EXPECT_LE(error, 1e-2) << describe(m) << ", " << name_of(technique);
            sum[c] += (first[c].mean() + rest[c].mean()) / 24;
            variance[c] += square(error / 24);
          }
        }
      }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(sum[c], 1, 1e-3 + 3 * std::sqrt(variance[c]));
    EXPECT_LE(std::sqrt(variance[c]), 1e-3);
  }
}

// Over a black base the rest is what bounces more than once. A film that reflects much, so that there is
// something to see. 4 surfaces x 2 modes x 2 techniques x 3 channels: 1e-3 in all.
TEST(MultipleFacets, RestOverBlackAgreesWithThePlainWalk) {
  const test::CellGrid grid;
  const Vec3 wi = spherical_direction(0.9, 0.4);
  for (const auto& roughness : {Roughness(0.3), Roughness(0.6), Roughness(1), Roughness(0.2, 0.7)})
    for (const auto transmission : kTransmissions) {
      Material m = facets(roughness, transmission, Rgb(0));
      m.film_ior = 2.5;
      m.film_thickness_nm = 60;
      Rng rng(3, 0);
      const auto expected = test::PlainFacetLayers(m, kNm).histogram(wi, grid, 300000, rng).cells();
      const Pfmc pfmc(m);
      for (const Technique technique : kTechniques) {
        const auto found = test::integrate_cells(grid, 1500, rng, [&](const Vec3& wo, Rng& r) {
          return pfmc.estimate_rest(wo, wi, r, technique) * wo.z;
        });
        EXPECT_GT(test::least_p_value(expected, found), test::sidak(1e-3, 48))
            << describe(m) << ", " << name_of(technique);
        EXPECT_GT(test::compare_cells(expected, found, 0).degrees, 3) << describe(m);
      }
    }
}

// Over a base, in total, with and without pigment. 3 surfaces x 2 modes x 2 pigments x 3 channels at 4
// standard errors (6e-5), each of 0.1 % of the light: 2.3e-3 in all.
TEST(MultipleFacets, AlbedoAgreesWithThePlainWalk) {
  const Vec3 wo = spherical_direction(0.9, 0.4);
  const test::Effort effort{.error = 0, .absolute = 1e-3};
  for (const auto& roughness : {Roughness(0.3), Roughness(0.9), Roughness(0.2, 0.7)})
    for (const auto transmission : kTransmissions)
      for (const bool has_pigment : {false, true}) {
        Material m = facets(roughness, transmission, {0.9, 0.7, 0.4});
        if (has_pigment) {
          m.absorption_per_nm = 0.1 / m.pigment_thickness_nm;
          m.scattering_per_nm = 0.8 / m.pigment_thickness_nm;
          m.anisotropy = 0.5;
        }
        Rng rng(4, 0);
        const test::PlainFacetLayers plain(m, kNm);
        const test::PlainFilm first(m, kNm);
        const auto expected = test::until_known(effort, [&] {
          const auto outcome = plain.walk(wo, rng);
          return first.reflected(wo, rng) + (outcome ? outcome->power : Rgb());
        });
        const auto found = test::sampled_albedo(LiveBsdf(m), wo, effort, rng);
        test::expect_agree(found, expected, 4, 0, describe(m) + (has_pigment ? " pigment" : ""));
        for (int c = 0; c < 3; ++c) EXPECT_LE(found[c].std_error(), 1e-3) << describe(m);
      }
}

// A smooth film has no facets.
TEST(MultipleFacets, SmoothFilmIsTheSame) {
  const Vec3 wo = spherical_direction(0.9, 0.4), wi = spherical_direction(0.3, 2.5);
  for (const auto& [name, material] : test::all_modes()) {
    if (!material.is_smooth()) continue;
    Material multiple = material;
    multiple.microfacet = Microfacet::multiple;
    const LiveBsdf one(material), other(multiple);
    Rng first(5, 0), second(5, 0);
    for (int i = 0; i < 200; ++i) {
      EXPECT_EQ(one.eval(wo, wi, first), other.eval(wo, wi, second)) << name;
      EXPECT_EQ(one.pdf(wo, wi, first), other.pdf(wo, wi, second)) << name;
      const auto s = one.sample(wo, first), t = other.sample(wo, second);
      ASSERT_EQ(s.has_value(), t.has_value()) << name;
      if (!s) continue;
      EXPECT_EQ(s->throughput, t->throughput) << name;
    }
  }
}

// Facets of a film that is hardly rough do not see each other: what single scattering loses goes with
// alpha^2. 4 modes x 2 techniques x 3 channels at 4.5 standard errors: 1.6e-4.
TEST(MultipleFacets, SmallRoughnessTendsToSingle) {
  const Vec3 wo = spherical_direction(0.7, 0), wi = spherical_direction(0.4, 2);
  for (const auto& [name, material] : test::all_modes(0.005)) {
    if (material.is_smooth()) continue;
    Material multiple = material;
    multiple.microfacet = Microfacet::multiple;
    const Rgb single = ExactRest(material, Wavelengths::rgb3(material)).rest(wo, wi);
    for (const Technique technique : kTechniques) {
      Rng rng(6, 0);
      const auto found = test::mean_rest(Pfmc(multiple), wo, wi, technique, {2e-3, 0, 500, 30000}, rng);
      test::expect_agree(found, single, 4.5, 1e-3, name + ", " + name_of(technique));
      const Rgb gap = Pfmc(multiple).first(wo, wi) - Pfmc(material).first(wo, wi);
      EXPECT_TRUE(is_black(gap)) << name;  // the first surface is one bounce in both models
    }
  }
}

// What is not asked for is not followed: the default is the single-scattering film that the exact evaluator
// solves, though at roughness 1 the two models are far apart. 4 modes x 3 channels at 4.5 standard errors:
// 8e-5.
TEST(MultipleFacets, SingleIsTheDefault) {
  const Vec3 wo = spherical_direction(0.7, 0), wi = spherical_direction(0.4, 2);
  ASSERT_EQ(Material().microfacet, Microfacet::single);
  for (const auto& [name, material] : test::all_modes(1)) {
    if (material.is_smooth()) continue;
    Material multiple = material;
    multiple.microfacet = Microfacet::multiple;
    const Rgb single = ExactRest(material, Wavelengths::rgb3(material)).rest(wo, wi);
    Rng rng(10, 0);
    const auto rest = [&](const Material& m) {
      return test::mean_rest(Pfmc(m), wo, wi, Technique::unidirectional, {2e-3, 0, 500, 30000}, rng);
    };
    test::expect_agree(rest(material), single, 4.5, 1e-3, name);
    EXPECT_GT(rest(multiple).g.mean(), 1.02 * single.g) << name;
  }
}

// Values and noise are continuous where facets cease to bend light. 2 x 3 means at 4.5 standard errors, 4e-5.
// Variances differ by a quarter.
TEST(MultipleFacets, IndexMatchIsNoSpecialCase) {
  const Vec3 wo = spherical_direction(0.3, 0), wi = spherical_direction(0.7, 2);
  for (const double roughness : {0.1, 0.4}) {
    const auto run = [&](double base_ior) {
      Material m = facets(roughness, Transmission::refract, {0.9, 0.7, 0.4});
      m.base_ior = base_ior;
      const Pfmc pfmc(m);
      Rng rng(8, 0);
      test::RunningMean mean;
      for (int i = 0; i < 20000; ++i) mean.add(pfmc.estimate_rest(wo, wi, rng).g);
      return mean;
    };
    const auto at_one = run(1);
    const std::pair<double, double> steps[] = {{1 + 1e-8, 0}, {1.0001, 0.002}, {1.01, 0.06}};
    for (const auto& [base_ior, allowed] : steps) {
      const auto near_one = run(base_ior);
      EXPECT_NEAR(near_one.mean(), at_one.mean(),
                  4.5 * std::hypot(near_one.std_error(), at_one.std_error()) + allowed * at_one.mean())
          << base_ior << " roughness " << roughness;
      EXPECT_LT(near_one.variance(), 2 * at_one.variance()) << base_ior << " roughness " << roughness;
      EXPECT_GT(near_one.variance(), at_one.variance() / 2) << base_ior << " roughness " << roughness;
    }
    EXPECT_LT(at_one.std_error(), 0.003 * at_one.mean());
  }
}

// 4 surfaces x 2 modes x 2 techniques x 3 channels at 4.5 standard errors (7e-6): 4e-4 in all.
TEST(MultipleFacets, EvalIsReciprocal) {
  const Vec3 a = spherical_direction(0.4, 0), b = spherical_direction(1.2, 2);
  for (const auto& roughness : {Roughness(0.1), Roughness(0.5), Roughness(1), Roughness(0.2, 0.7)})
    for (const auto transmission : kTransmissions)
      for (const Technique technique : kTechniques) {
        const Material m = facets(roughness, transmission, {0.9, 0.7, 0.4});
        const LiveBsdf bsdf(m, Wavelengths::rgb3(m), technique);
        const auto gap = test::reciprocity_gap(bsdf, a, b, 4000, 7);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(gap[c].mean(), 0, 4.5 * gap[c].std_error() + 1e-12) << describe(m) << " channel " << c;
      }
}

// 3 surfaces x 2 modes x 2 spectra: 1e-3 in all.
TEST(MultipleFacets, SamplesFollowThePdf) {
  std::vector<test::NamedMaterial> materials;
  for (const auto& roughness : {Roughness(0.3), Roughness(1), Roughness(0.2, 0.7)})
    for (const auto transmission : kTransmissions) {
      const Material m = facets(roughness, transmission, {0.9, 0.7, 0.4});
      materials.push_back({describe(m), m});
    }
  for (const auto& [name, material, wavelengths] : test::in_both_spectra(materials)) {
    const auto result =
        test::chi_square_of_sampling(LiveBsdf(material, wavelengths), spherical_direction(0.9, 0.4),
                                     {.samples = 40000, .points = 2, .pdf_samples = 16}, 8);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 12)) << name;
    EXPECT_GT(result.degrees, 100) << name;
  }
}

}  // namespace
}  // namespace sunbeam
