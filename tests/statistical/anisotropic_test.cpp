// The live model of films with two roughnesses: limits, symmetries, and its own contract. Fixed seeds; the
// stated rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/exact.h"
#include "bake/live/live_bsdf.h"
#include "tests/support/configurations.h"
#include "tests/support/estimates.h"
#include "tests/support/plain_slab.h"

namespace sunbeam {
namespace {

using test::kTechniques;
using test::name_of;

// Straight and refracting films; in the pigment both paths.
std::vector<test::NamedMaterial> brushed(const Roughness& roughness) {
  std::vector<test::NamedMaterial> result;
  for (auto [name, material] : test::all_modes())
    if (!material.is_smooth()) {
      material.roughness = roughness;
      result.push_back({name, material});
    }
  return result;
}

const Vec3 kOut = spherical_direction(0.9, 0.4), kIn = spherical_direction(0.6, 2.5);
const test::Effort kEffort{2e-3, 0, 500, 30000};

Vec3 quarter_turn(const Vec3& w) { return {-w.y, w.x, w.z}; }
Vec3 mirror_x(const Vec3& w) { return {-w.x, w.y, w.z}; }
Vec3 mirror_y(const Vec3& w) { return {w.x, -w.y, w.z}; }

void expect_equal(const Rgb& a, const Rgb& b, double relative, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], relative * std::abs(b[c])) << what;
}

// A pair hardly apart takes the general way to the isotropic result. 4 modes x 2 techniques x 3 channels at
// 4.5 standard errors: 1.6e-4.
TEST(Anisotropic, NearlyEqualRoughnessIsIsotropic) {
  const auto pairs = brushed({0.3, 0.3000001}), isotropic = brushed(0.3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [name, material] = pairs[i];
    const Material& plain = isotropic[i].material;
    const Pfmc pfmc(material);
    expect_equal(pfmc.first(kOut, kIn), Pfmc(plain).first(kOut, kIn), 3e-6, name);
    const Rgb exact = ExactRest(plain, Wavelengths::rgb3(plain)).rest(kOut, kIn);
    for (const Technique technique : kTechniques) {
      Rng rng(1, 0);
      const auto found = test::mean_rest(pfmc, kOut, kIn, technique, kEffort, rng);
      test::expect_agree(found, exact, 4.5, 3e-4, name + ", " + name_of(technique));
    }
  }
}

// By sampling, film and all. 4 modes x 3 channels at 4.5 standard errors: 8e-5.
TEST(Anisotropic, NearlyEqualRoughnessHasTheIsotropicAlbedo) {
  const auto pairs = brushed({0.3, 0.3000001}), isotropic = brushed(0.3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Material& plain = isotropic[i].material;
    Rng rng(2, 0);
    const auto found = test::sampled_albedo(LiveBsdf(pairs[i].material), kOut, {1e-3, 0, 2000, 400000}, rng);
    test::expect_agree(found, ExactRest(plain, Wavelengths::rgb3(plain)).albedo(kOut), 4.5, 3e-4,
                       pairs[i].name);
  }
}

// Value of the same light under a symmetry of the film. 4 modes x 2 techniques x 3 symmetries x 3 channels at
// 4.5 standard errors: 5e-4.
TEST(Anisotropic, HasTheSymmetriesOfTheFilm) {
  const auto along_y = brushed({0.1, 0.4}), along_x = brushed({0.4, 0.1});
  for (std::size_t i = 0; i < along_y.size(); ++i) {
    const auto& [name, material] = along_y[i];
    const Pfmc pfmc(material), turned(along_x[i].material);
    const Rgb first = pfmc.first(kOut, kIn);
    expect_equal(turned.first(quarter_turn(kOut), quarter_turn(kIn)), first, 1e-12, name);
    expect_equal(pfmc.first(mirror_x(kOut), mirror_x(kIn)), first, 1e-12, name);
    expect_equal(pfmc.first(mirror_y(kOut), mirror_y(kIn)), first, 1e-12, name);
    for (const Technique technique : kTechniques) {
      const auto mean = [&](const Pfmc& model, const Vec3& wo, const Vec3& wi, int stream) {
        Rng rng(3, stream);
        return test::mean_rest(model, wo, wi, technique, kEffort, rng);
      };
      const auto found = mean(pfmc, kOut, kIn, 0);
      const std::string what = name + ", " + name_of(technique);
      test::expect_agree(mean(turned, quarter_turn(kOut), quarter_turn(kIn), 1), found, 4.5, 0, what);
      test::expect_agree(mean(pfmc, mirror_x(kOut), mirror_x(kIn), 2), found, 4.5, 0, what);
      test::expect_agree(mean(pfmc, mirror_y(kOut), mirror_y(kIn), 3), found, 4.5, 0, what);
    }
  }
}

// Light that passes sees how rough the film is along its own azimuth, by percents at grazing. A model without
// it would have all the symmetries above.
TEST(Anisotropic, RestDependsOnAzimuth) {
  const Material m = brushed({0.05, 0.8}).back().material;
  ASSERT_EQ(m.transmission, Transmission::refract);
  const Vec3 x = spherical_direction(1.3, 0), y = spherical_direction(1.3, kPi / 2);
  Rng rng(4, 0);
  const auto along = test::mean_rest(Pfmc(m), x, kIn, Technique::unidirectional, kEffort, rng).g;
  const auto across = test::mean_rest(Pfmc(m), y, kIn, Technique::unidirectional, kEffort, rng).g;
  EXPECT_GT(test::deviation(along.mean(), along.std_error(), across.mean(), across.std_error()), 6);
}

// Against the analog walk, cell by cell, where azimuth counts and where the slab scatters too. 2 roughnesses
// x 2 transmissions x 2 pigments x 2 techniques x 3 channels: 1e-3 in all.
TEST(Anisotropic, EstimatesAgreeWithTheAnalogWalk) {
  const test::CellGrid grid;
  const Vec3 wi = spherical_direction(1.1, 0.4);
  for (const auto& roughness : {Roughness(0.1, 0.4), Roughness(0.9, 0.2)})
    for (auto [name, material] : brushed(roughness)) {
      if (material.absorption_path == AbsorptionPath::product) continue;
      for (const double scattering : {0.0, 1.0}) {
        material.scattering_per_nm = scattering / material.pigment_thickness_nm;
        material.anisotropy = 0.6;
        Rng rng(5, 0);
        const auto expected =
            test::PlainSlab(material, {650, 510, 475}).histogram(wi, grid, 150000, rng).cells();
        const Pfmc pfmc(material);
        for (const Technique technique : kTechniques) {
          const auto found = test::integrate_cells(grid, 150, rng, [&](const Vec3& wo, Rng& r) {
            return pfmc.estimate_rest(wo, wi, r, technique) * wo.z;
          });
          EXPECT_GT(test::least_p_value(expected, found), test::sidak(1e-3, 48))
              << name << ", " << name_of(technique) << ", scattering " << scattering;
        }
      }
    }
}

// Over a black base there is only the first surface, whose density is exact. 3 roughnesses x 2 directions:
// 1e-3 in all.
TEST(Anisotropic, FirstSurfaceIsSampledByItsDensity) {
  for (const auto& roughness : {Roughness(0.1, 0.4), Roughness(0.4, 0.1), Roughness(0.9, 0.2)})
    for (const Vec3& wo : {kOut, spherical_direction(0.3, 2.5)}) {
      Material m = brushed(roughness).back().material;
      m.albedo = Rgb(0);
      const auto result = test::chi_square_of_sampling(LiveBsdf(m), wo,
                                                       {.samples = 60000, .points = 12, .pdf_samples = 2}, 6);
      EXPECT_GT(result.p_value, test::sidak(1e-3, 6)) << roughness.u << " cos " << wo.z;
      EXPECT_GT(result.degrees, 30) << roughness.u;
    }
}

// 4 modes x 2 spectra: 1e-3 in all.
TEST(Anisotropic, SamplesFollowThePdf) {
  for (const auto& [name, material, wavelengths] : test::in_both_spectra(brushed({0.1, 0.4}))) {
    const auto result = test::chi_square_of_sampling(LiveBsdf(material, wavelengths), kOut,
                                                     {.samples = 60000, .points = 2, .pdf_samples = 32}, 7);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 8)) << name;
    EXPECT_GT(result.degrees, 150) << name;
  }
}

// 4 modes x 2 spectra x 2 techniques x 3 channels at 4.5 standard errors (7e-6): 3e-4 in all.
TEST(Anisotropic, EvalIsReciprocal) {
  const Vec3 a = spherical_direction(0.4, 0), b = spherical_direction(1.2, 2);
  for (const auto& [name, material, wavelengths] : test::in_both_spectra(brushed({0.1, 0.4})))
    for (const Technique technique : kTechniques) {
      const LiveBsdf bsdf(material, wavelengths, technique);
      const auto gap = test::reciprocity_gap(bsdf, a, b, 10000, 8);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(gap[c].mean(), 0, 4.5 * gap[c].std_error() + 1e-12) << name << " channel " << c;
    }
}

}  // namespace
}  // namespace sunbeam
