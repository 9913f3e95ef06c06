// The live model of films with two roughnesses: limits, symmetries, and its own contract. Fixed seeds; the
// stated rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "bake/live/live_bsdf.h"
#include "sunbeam/detail/quadrature.h"
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

ExactRest exact_of(const Material& m, const ExactResolution& resolution = {}) {
  return ExactRest(m, Wavelengths::rgb3(m), resolution);
}

// The quadrature over azimuths of facets, too, whichever tangent has the larger roughness.
TEST(Anisotropic, ExactIsTheIsotropicOneInTheLimit) {
  for (const double apart : {-1e-9, 1e-9}) {
    const auto pairs = brushed({0.2, 0.2 + apart}), isotropic = brushed(0.2);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const ExactRest pair = exact_of(pairs[i].material), plain = exact_of(isotropic[i].material);
      expect_equal(pair.rest(kOut, kIn), plain.rest(kOut, kIn), 1e-8, pairs[i].name);
      expect_equal(pair.albedo(kOut), plain.albedo(kOut), 1e-8, pairs[i].name);
    }
  }
}

// Walks until the standard error of their grey is 0.1 %, at directions along, across and between the grooves.
// 4 modes x 3 materials x 3 channels at 4.5 standard errors (7e-6): 2.5e-4 in all.
TEST(Anisotropic, ExactIsTheMeanOfWalks) {
  struct Case {
    Roughness roughness;
    double base_ior;
    Vec3 wo, wi;
  };
  const Case cases[] = {{{0.1, 0.3}, 1.6, spherical_direction(1.3, 0), spherical_direction(0.8, 2)},
                        {{0.7, 0.05}, 1.3, spherical_direction(1.2, 0), spherical_direction(1.3, kPi / 2)},
                        {{0.2, 0.8}, 0.9, kOut, kIn}};
  for (const Case& c : cases)
    for (auto [name, material] : brushed(c.roughness)) {
      material.base_ior = c.base_ior;
      Rng rng(13, 0);
      const auto found =
          test::mean_rest(Pfmc(material), c.wo, c.wi, Technique::unidirectional, {1e-3, 0, 500, 30000}, rng);
      test::expect_agree(found, exact_of(material).rest(c.wo, c.wi), 4.5, 3e-4, name);
    }
}

TEST(Anisotropic, ExactHasTheSymmetriesOfTheFilm) {
  const auto along_y = brushed({0.1, 0.4}), along_x = brushed({0.4, 0.1});
  for (std::size_t i = 0; i < along_y.size(); ++i) {
    const auto& name = along_y[i].name;
    const ExactRest exact = exact_of(along_y[i].material);
    const Rgb rest = exact.rest(kOut, kIn);
    expect_equal(exact.rest(kIn, kOut), rest, 1e-12, name);
    expect_equal(exact_of(along_x[i].material).rest(quarter_turn(kOut), quarter_turn(kIn)), rest, 1e-8, name);
    for (const auto& mirror : {mirror_x, mirror_y}) {
      expect_equal(exact.rest(mirror(kOut), mirror(kIn)), rest, 1e-8, name);
      expect_equal(exact.rest(mirror(kOut), kIn), rest, 1e-8, name);  // the base forgets azimuths
      expect_equal(exact.albedo(mirror(kOut)), exact.albedo(kOut), 1e-8, name);
    }
  }
}

TEST(Anisotropic, ExactAlbedoIsTheIntegralOfRest) {
  constexpr int kAzimuths = 16;
  const GaussRule cosines = gauss_legendre(12);
  for (const auto& [name, material] : brushed({0.15, 0.4})) {
    const ExactRest exact = exact_of(material);
    std::vector<Vec3> wi;
    std::vector<double> weight;
    for (int i = 0; i < cosines.size(); ++i)
      for (int k = 0; k < kAzimuths; ++k) {
        const double root = cosines.node[i];  // of the cosine: the rest bends towards grazing
        wi.push_back(direction_from_cosine(root * root, 2 * kPi * (k + 0.5) / kAzimuths));
        weight.push_back(cosines.weight[i] * 2 * root * root * root * 2 * kPi / kAzimuths);
      }
    const auto rest = exact.rest(wi, kOut);
    Rgb sum;
    for (std::size_t k = 0; k < rest.size(); ++k) sum += rest[k] * weight[k];
    expect_equal(sum, exact.rest_albedo(kOut), 1e-4, name);
  }
}

// More nodes change nothing beyond the errors that exact.h states, over higher and lower indices.
TEST(Anisotropic, ExactHasConverged) {
  const ExactResolution finer{14, 36, 18, 24, 40};
  Rng rng(14, 0);
  for (int trial = 0; trial < 32; ++trial) {
    Material m =
        brushed({0.01 + 0.9 * square(rng.uniform()), 0.01 + 0.9 * square(rng.uniform())})[trial % 4].material;
    m.film_thickness_nm = 1500 * rng.uniform();
    m.exterior_ior = trial < 16 ? 1 : 1.05 + 0.95 * rng.uniform();
    m.base_ior = trial < 16 ? 1.05 + rng.uniform() : lerp(rng.uniform(), 1, m.exterior_ior - 0.01);
    m.absorption_per_nm = std::pow(10, -4 + 4 * rng.uniform());
    const ExactRest exact = exact_of(m), fine = exact_of(m, finer);
    const Vec3 wo = spherical_direction(1.5 * rng.uniform(), 2 * kPi * rng.uniform());
    const Vec3 wi = spherical_direction(1.5 * rng.uniform(), 2 * kPi * rng.uniform());
    const Rgb expected = fine.rest(wo, wi);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(exact.rest(wo, wi)[c], expected[c], 5e-4 * expected[c] + 1e-15) << "trial " << trial;
    expect_equal(exact.albedo(wo), fine.albedo(wo), 5e-4, "trial " + std::to_string(trial));
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
