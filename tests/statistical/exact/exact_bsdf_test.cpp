// The fast evaluator of path "sum" against the exact one it tabulates, known values, and itself.
#include "bake/live/exact/exact_bsdf.h"

#include <gtest/gtest.h>

#include "bake/live/pfmc.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/materials.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const Vec3 kGrazing = spherical_direction(1.4, 2);

std::vector<test::NamedMaterial> sum_modes(double roughness = 0.3, double optical_depth = 0.1) {
  std::vector<test::NamedMaterial> modes;
  for (auto& mode : test::all_modes(roughness, optical_depth))
    if (mode.material.absorption_path == AbsorptionPath::sum) modes.push_back(mode);
  return modes;
}

Material coated_diffuse() {
  Material m;
  m.film_thickness_nm = 0;
  m.film_ior = m.base_ior = 1.5;
  m.absorption_per_nm = 0.005;
  m.albedo = Rgb(0.5);
  m.roughness = 0;
  return m;
}

// Twenty wavelengths with albedos and absorptions of their own; weights of either sign.
Wavelengths twenty() {
  Wavelengths w;
  for (int k = 0; k < 20; ++k) {
    w.nm.push_back(400 + 15 * k);
    w.albedo.push_back(0.9 - 0.04 * k);
    w.absorption.push_back(3.0 / (1 + 0.2 * k));
    w.weight.push_back({0.12 * k / 20 - 0.01, 0.05, 0.1 - 0.005 * k});
  }
  return w;
}

// Values of an independent solver, six digits.
TEST(ExactBsdf, KnownCoatedDiffuse) {
  const ExactBsdf bsdf(coated_diffuse(), Wavelengths::monochromatic(coated_diffuse(), 550));
  const double rows[][4] = {
      {60, 30, 120, 0.0842593}, {10, 45, 60, 0.0881279}, {80, 20, 90, 0.0566795}, {45, 43, 178, 0.0872790}};
  Rng rng(1, 0);
  for (const auto& [theta_o, theta_i, phi, expected] : rows) {
    const Vec3 wo = spherical_direction(theta_o * kPi / 180, 0);
    const Vec3 wi = spherical_direction(theta_i * kPi / 180, phi * kPi / 180);
    EXPECT_NEAR(bsdf.eval(wo, wi, rng).g, expected, 6e-8) << theta_o;
  }
}

// The stated errors, over random materials of every kind that is_valid_for() allows.
TEST(ExactBsdf, IsTheExactRest) {
  Rng rng(2, 0);
  for (int trial = 0; trial < 100; ++trial) {
    const bool rough = trial % 4 == 0;
    Material m =
        sum_modes(std::max(kMinRoughness, std::pow(rng.uniform(), 3)))[2 * rough + trial / 4 % 2].material;
    m.film_thickness_nm = 1500 * rng.uniform();
    m.base_ior = trial % 12 == 0 ? 1.0001 : trial % 12 == 1 ? 1 : 1 + rng.uniform();
    if (!rough) m.exterior_ior = 1 + rng.uniform();
    if (!rough && trial % 10 == 1) m.film_thickness_nm = 50000;
    m.absorption_per_nm = std::pow(10, -4 + 4 * rng.uniform());
    const auto wavelengths = Wavelengths::rgb3(m);
    const ExactRest exact(m, wavelengths);
    const ExactBsdf bsdf(m, wavelengths);
    for (int k = 0; k < 20; ++k) {
      const double least = rough ? 0.05 : 1e-4;
      const Vec3 wo = direction_from_cosine(lerp(rng.uniform(), least, 1), 0);
      const Vec3 wi = direction_from_cosine(std::max(least, std::pow(10, -4 * rng.uniform())), 2);
      const Rgb expected = exact.rest(wo, wi), found = bsdf.rest(wo, wi);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], expected[c], 1e-5 * expected[c] + 1e-14)
            << "trial " << trial << ' ' << wo.z << ' ' << wi.z;
    }
  }
}

TEST(ExactBsdf, NearGrazingARoughFilmStaysWithinTheExactError) {
  for (const auto& [name, m] : sum_modes(0.1)) {
    const ExactRest exact(m, Wavelengths::rgb3(m));
    const ExactBsdf bsdf(m, Wavelengths::rgb3(m));
    for (const double cosine : {1e-4, 1e-3, 0.01, 0.04}) {
      const Vec3 wi = direction_from_cosine(cosine, 1);
      const Rgb expected = exact.rest(kOblique, wi), found = bsdf.rest(kOblique, wi);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], expected[c], 2e-4 * expected[c] + 1e-14) << name << ' ' << cosine;
    }
  }
}

TEST(ExactBsdf, FirstSurfaceIsTheFilms) {
  Rng rng(3, 0);
  for (const double exterior_ior : {1.0, 1.6})
    for (const double thickness : {350.0, 4000.0})
      for (auto [name, m] : sum_modes()) {
        m.exterior_ior = exterior_ior;
        m.film_thickness_nm = thickness;
        const Pfmc pfmc(m);
        const ExactBsdf bsdf(m, Wavelengths::rgb3(m));
        for (int k = 0; k < 200; ++k) {
          const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
          const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
          const double lobe = m.is_smooth() ? 0 : Ggx(m.roughness).reflection(wo, wi, normalize(wo + wi));
          const Rgb first = pfmc.first(wo, wi), dirac = pfmc.dirac(wo);
          for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(bsdf.first(wo, wi)[c], first[c], 1e-5 * first[c] + 1e-7 * lobe) << name;
            EXPECT_NEAR(bsdf.dirac(wo)[c], dirac[c], 1e-5 * dirac[c] + 1e-7) << name;
          }
        }
      }
}

TEST(ExactBsdf, FoldsManyWavelengths) {
  for (const auto& [name, m] : sum_modes()) {
    const ExactRest exact(m, twenty());
    const ExactBsdf bsdf(m, twenty());
    const Rgb expected = exact.rest(kOblique, kGrazing), found = bsdf.rest(kOblique, kGrazing);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2e-5 * max_component(expected)) << name;
    EXPECT_EQ(found, bsdf.rest(kGrazing, kOblique)) << name;
  }
}

// 12 tests, false alarm 1e-3 in all.
TEST(ExactBsdf, SamplesFollowThePdf) {
  for (const auto& [name, m] : sum_modes())
    for (const Vec3& wo : {kOblique, kGrazing, spherical_direction(0.1, 0)}) {
      const ExactBsdf bsdf(m, Wavelengths::rgb3(m));
      const auto result = test::chi_square_of_sampling(bsdf, wo, {.samples = 400000}, 4);
      EXPECT_GT(result.p_value, test::sidak(1e-3, 12)) << name << " cos " << wo.z;
      const auto sampled = test::sample_totals(bsdf, wo, 400000, 5);
      const auto probability = test::integrate_pdf(bsdf, wo, 100, 16, 5);
      EXPECT_NEAR(probability.mean() + sampled.dirac + sampled.empty, 1,
                  5 * std::hypot(probability.std_error(), sampled.seen.std_error()) + 1e-4)
          << name << " cos " << wo.z;
    }
}

// Power by sampling is the exact albedo: 4 materials x 2 sets of wavelengths x 2 views x 3 channels at 4.5
// standard errors, 4e-4 in all.
TEST(ExactBsdf, AlbedoBySampling) {
  for (const auto& [name, m] : sum_modes())
    for (const auto& wavelengths : {Wavelengths::rgb3(m), twenty()}) {
      const ExactRest exact(m, wavelengths);
      const ExactBsdf bsdf(m, wavelengths);
      for (const Vec3& wo : {kOblique, kGrazing}) {
        const auto sampled = test::sample_totals(bsdf, wo, 200000, 6).albedo;
        const Rgb expected = exact.albedo(wo);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(sampled[c].mean(), expected[c], 4.5 * sampled[c].std_error() + 5e-5) << name;
        EXPECT_LT(sampled.grey.std_error(), 0.003 * mean(expected)) << name;
      }
    }
}

// Facing a lower index, a smooth film lets nothing through beyond the critical angle.
TEST(ExactBsdf, TotalReflection) {
  Material m = coated_diffuse();
  m.exterior_ior = 1.8;
  const ExactBsdf bsdf(m, Wavelengths::rgb3(m));
  Rng rng(7, 0);
  EXPECT_TRUE(is_black(bsdf.eval(kOblique, kGrazing, rng)));
  EXPECT_NEAR(bsdf.dirac(kGrazing).g, 1, 1e-7);
  const auto totals = test::sample_totals(bsdf, kGrazing, 1000, 7);
  EXPECT_NEAR(totals.albedo.mean().g, 1, 0.05);
}

TEST(ExactBsdf, NothingBelowTheHorizonOrOfABlackBase) {
  const Vec3 below = spherical_direction(2, 0);
  for (auto [name, m] : sum_modes()) {
    const ExactBsdf bsdf(m, Wavelengths::rgb3(m));
    m.albedo = Rgb(0);
    const ExactBsdf black(m, Wavelengths::rgb3(m));
    Rng rng(8, 0), untouched(8, 0);
    EXPECT_TRUE(is_black(bsdf.eval(kOblique, below, rng))) << name;
    EXPECT_TRUE(is_black(bsdf.eval(below, kOblique, rng))) << name;
    EXPECT_TRUE(is_black(bsdf.dirac(below))) << name;
    EXPECT_EQ(bsdf.pdf(kOblique, below, rng), 0) << name;
    EXPECT_TRUE(is_black(black.rest(kOblique, kOblique))) << name;
    EXPECT_EQ(rng.next(), untouched.next()) << name << ": eval and pdf draw no numbers";
    EXPECT_FALSE(bsdf.sample(below, rng)) << name;
  }
}

TEST(ExactBsdf, ValidForSumAlone) {
  Material m;
  m.absorption_path = AbsorptionPath::sum;
  m.film_thickness_nm = ExactBsdf::kThickestRoughNm;
  EXPECT_TRUE(ExactBsdf::is_valid_for(m));
  m.film_thickness_nm *= 1.01;
  EXPECT_FALSE(ExactBsdf::is_valid_for(m));
  m.roughness = 0;
  EXPECT_TRUE(ExactBsdf::is_valid_for(m));
  m.absorption_path = AbsorptionPath::product;
  EXPECT_FALSE(ExactBsdf::is_valid_for(m));
}

}  // namespace
}  // namespace sunbeam
