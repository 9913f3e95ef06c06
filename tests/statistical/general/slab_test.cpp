// The live model of a scattering pigment against an analog walk (plain_slab.h), against adding and doubling,
// and in its own contract. Fixed seeds; the stated rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "bake/live/live_bsdf.h"
#include "tests/support/adding_doubling.h"
#include "tests/support/configurations.h"
#include "tests/support/estimates.h"
#include "tests/support/plain_slab.h"

namespace sunbeam {
namespace {

using test::kTechniques;
using test::name_of;

const Rgb kNm(650, 510, 475);

Material slab(const Roughness& roughness, Transmission transmission, double scattering, double g,
              double absorption) {
  Material m;
  m.transmission = transmission;
  m.film_thickness_nm = 350;
  m.base_ior = 1.4;
  m.absorption_per_nm = absorption / m.pigment_thickness_nm;
  m.scattering_per_nm = scattering / m.pigment_thickness_nm;
  m.anisotropy = g;
  m.albedo = {0.9, 0.6, 0.3};
  m.roughness = roughness;
  return m;
}

// Films, optical thicknesses, phase functions and absorption, each with each other somewhere.
std::vector<test::NamedMaterial> slabs() {
  struct Row {
    Roughness roughness;
    Transmission transmission;
    double scattering, g, absorption;
  };
  constexpr auto straight = Transmission::straight, refract = Transmission::refract;
  const Row rows[] = {
      {0, refract, 0.1, 0, 0},    {0, refract, 1, 0.5, 0.3},   {0, refract, 5, 0.9, 0},
      {0, straight, 1, 0, 0},     {0, straight, 5, 0.5, 0.3},  {0, straight, 0.1, 0.9, 0.3},
      {0.3, refract, 1, 0, 0},    {0.3, refract, 5, 0.9, 0.3}, {0.3, refract, 0.1, 0.5, 0},
      {0.3, straight, 1, 0.9, 0}, {0.3, straight, 5, 0, 0},    {{0.1, 0.4}, refract, 1, 0.5, 0}};
  std::vector<test::NamedMaterial> result;
  for (const Row& r : rows) {
    const Material m = slab(r.roughness, r.transmission, r.scattering, r.g, r.absorption);
    result.push_back({to_string(r.roughness) + " " + std::string(to_string(r.transmission)) + " " +
                          std::to_string(r.scattering) + " g " + std::to_string(r.g) + " absorbs " +
                          std::to_string(r.absorption),
                      m});
  }
  return result;
}

// Forward peaks give connections long tails: fewer cells, each with so many points that normal errors
// describe their means.
bool is_peaked(const Material& material) { return material.anisotropy > 0.8; }

// Cell by cell of the outgoing hemisphere. 12 slabs x 2 techniques x 3 channels: 1e-3 in all.
TEST(Slab, EstimatesAgreeWithTheAnalogWalk) {
  const Vec3 wi = spherical_direction(0.7, 0.4);
  for (const auto& [name, material] : slabs()) {
    const auto grid = is_peaked(material) ? test::CellGrid{2, 4} : test::CellGrid{4, 8};
    Rng rng(1, 0);
    const auto expected = test::PlainSlab(material, kNm).histogram(wi, grid, 150000, rng).cells();
    const Pfmc pfmc(material);
    for (const Technique technique : kTechniques) {
      const int points = is_peaked(material) ? 800 : 150;
      const auto found = test::integrate_cells(grid, points, rng, [&](const Vec3& wo, Rng& r) {
        return pfmc.estimate_rest(wo, wi, r, technique) * wo.z;
      });
      EXPECT_GT(test::least_p_value(expected, found), test::sidak(1e-3, 72))
          << name << ", " << name_of(technique);
      EXPECT_GE(test::compare_cells(expected, found, 0).degrees, is_peaked(material) ? 8 : 24) << name;
    }
  }
}

// Film and all, each to a standard error of 0.1 % of the light. 12 x 3 tests at 4 (6e-5): 2.3e-3 in all.
TEST(Slab, AlbedoAgreesWithTheAnalogWalk) {
  const Vec3 wo = spherical_direction(1, 0.4);
  const test::Effort effort{.error = 0, .absolute = 1e-3};
  for (const auto& [name, material] : slabs()) {
    Rng rng(2, 0);
    const test::PlainSlab plain(material, kNm);
    const auto expected = test::until_known(effort, [&] {
      const auto outcome = plain.walk(wo, rng);
      return plain.film().reflected(wo, rng) + (outcome ? outcome->power : Rgb());
    });
    const auto found = test::sampled_albedo(LiveBsdf(material), wo, effort, rng);
    test::expect_agree(found, expected, 4, 0, name);
    for (int c = 0; c < 3; ++c) EXPECT_LE(found[c].std_error(), 1e-3) << name;
  }
}

// Index matched on both sides: there is no film.
Material bare(double thickness, double albedo, double g, double base) {
  Material m;
  m.film_thickness_nm = 0;
  m.exterior_ior = m.film_ior = m.base_ior = 1;
  m.roughness = 0;
  m.pigment_thickness_nm = 1;
  m.scattering_per_nm = thickness * albedo;
  m.absorption_per_nm = thickness * (1 - albedo);
  m.anisotropy = g;
  m.albedo = Rgb(base);
  return m;
}

// An invisible film, over a black and a white base, to a standard error of 0.1 %. 9 slabs x 2 bases x 1
// channel (they are alike) at 4 (6e-5): 1.1e-3 in all. Adding and doubling is good to 1e-5.
TEST(Slab, BareSlabAgreesWithAddingDoubling) {
  const double cosine = 0.6;
  for (const double thickness : {0.1, 1.0, 5.0})
    for (const double g : {0.0, 0.5, 0.9}) {
      const double albedo = g == 0.5 ? 0.6 : 1;
      const test::AddingDoubling exact(thickness, albedo, g, {cosine});
      for (const double base : {0.0, 1.0}) {
        const Material m = bare(thickness, albedo, g, base);
        Rng rng(3, 0);
        const auto found =
            test::sampled_albedo(LiveBsdf(m, Wavelengths::monochromatic(m, 550)),
                                 spherical_direction(std::acos(cosine), 0.4), {0, 1e-3, 10000}, rng);
        EXPECT_NEAR(found.g.mean(), exact.reflectance_over(base, 0), 4 * found.g.std_error() + 1e-5)
            << thickness << " g " << g << " base " << base;
        EXPECT_LE(found.g.std_error(), 1e-3) << thickness << " g " << g << " base " << base;
      }
    }
}

// The same by connections, that is by integrating what eval() sees. 9 slabs x 2 techniques at 4.5 standard
// errors: 1.2e-4.
TEST(Slab, BareSlabAgreesByIntegration) {
  const double cosine = 0.6;
  const Vec3 wi = spherical_direction(std::acos(cosine), 0.4);
  for (const double thickness : {0.1, 1.0, 5.0})
    for (const double g : {0.0, 0.5, 0.9}) {
      const Material m = bare(thickness, 0.9, g, 0.5);
      const test::AddingDoubling exact(thickness, 0.9, g, {cosine});
      const Pfmc pfmc(m, Wavelengths::monochromatic(m, 550));
      for (const Technique technique : kTechniques) {
        Rng rng(4, 0);
        test::RunningMean found;
        for (const double total : test::integrate_stratified(12, 32, rng, [&](const Vec3&wo, Rng&r) {
               return pfmc.estimate_rest(wo, wi, r, technique).g * wo.z;
             }))
          found.add(total);
        EXPECT_NEAR(found.mean(), exact.reflectance_over(0.5, 0), 4.5 * found.std_error() + 1e-5)
            << thickness << " g " << g << ' ' << name_of(technique);
        EXPECT_LE(found.std_error(), technique == Technique::bidirectional ? 3e-3 : 1.5e-2)
            << thickness << " g " << g << ' ' << name_of(technique);
      }
    }
}

// A white slab over a white base under any smooth film returns all light. 2 x 3 angles at 4.5 standard
// errors: 4e-5.
TEST(Slab, WhiteFurnace) {
  for (const auto transmission : {Transmission::straight, Transmission::refract})
    for (const double theta : {0.0, 0.8, 1.4}) {
      Material m = slab(0, transmission, 2, 0.5, 0);
      m.albedo = Rgb(1);
      Rng rng(5, 0);
      const auto found = test::sampled_albedo(LiveBsdf(m, Wavelengths::monochromatic(m, 550)),
                                              spherical_direction(theta, 0), {2e-4, 0, 2000, 100000}, rng);
      EXPECT_NEAR(found.g.mean(), 1, 4.5 * found.g.std_error() + 1e-9) << to_string(transmission) << theta;
      EXPECT_LE(found.g.std_error(), 2e-3);
    }
}

void expect_same_bits(const Material& a, const Material& b, const std::string& name) {
  const Vec3 wo = spherical_direction(0.9, 0.4), wi = spherical_direction(0.3, 2.5);
  for (const Technique technique : kTechniques) {
    const LiveBsdf one(a, Wavelengths::rgb3(a), technique), other(b, Wavelengths::rgb3(b), technique);
    Rng first(6, 0), second(6, 0);
    for (int i = 0; i < 200; ++i) {
      EXPECT_EQ(one.eval(wo, wi, first), other.eval(wo, wi, second)) << name;
      EXPECT_EQ(one.pdf(wo, wi, first), other.pdf(wo, wi, second)) << name;
      const auto s = one.sample(wo, first), t = other.sample(wo, second);
      ASSERT_EQ(s.has_value(), t.has_value()) << name;
      if (!s) continue;
      EXPECT_EQ(s->throughput, t->throughput) << name;
      EXPECT_EQ(s->wi.x, t->wi.x) << name;
    }
    EXPECT_EQ(first.next(), second.next()) << name;
  }
}

// The phase function of nothing asks for nothing, nor does a scatterer in a pigment without thickness.
TEST(Slab, NoScatteringIsThePlainPigment) {
  for (const auto& [name, material] : test::all_modes()) {
    Material forward = material;
    forward.anisotropy = 0.7;
    expect_same_bits(material, forward, name);
    Material empty = material;
    empty.absorption_per_nm = 0;
    empty.pigment_thickness_nm = 0;
    Material thin = empty;
    thin.scattering_per_nm = 3;
    expect_same_bits(empty, thin, name);
  }
}

// Light that a smooth film reflects totally never comes in, and its walks end all the same.
TEST(Slab, NothingEntersBeyondTotalReflection) {
  Material m = slab(0, Transmission::straight, 0.5, 0.9, 0);
  m.exterior_ior = 1.5;
  m.base_ior = 1.2;
  const Vec3 wo = spherical_direction(0.2, 0), wi = spherical_direction(1.3, 2);
  for (const Technique technique : kTechniques) {
    Rng rng(12, 0);
    for (int i = 0; i < 20; ++i)
      EXPECT_NEAR(Pfmc(m).estimate_rest(wo, wi, rng, technique).g, 0, 1e-12) << name_of(technique);
  }
}

// A slab that hardly scatters is nearly the plain one. 4 films x 2 techniques x 3 channels at 4.5 standard
// errors: 1.6e-4.
TEST(Slab, LittleScatteringTendsToThePlainPigment) {
  const Vec3 wo = spherical_direction(0.7, 0), wi = spherical_direction(0.4, 2);
  for (const auto& [name, material] : test::all_modes()) {
    if (material.absorption_path == AbsorptionPath::product) continue;
    Material hazy = material;
    hazy.scattering_per_nm = 1e-5;
    const Rgb exact = ExactRest(material, Wavelengths::rgb3(material)).rest(wo, wi);
    for (const Technique technique : kTechniques) {
      Rng rng(7, 0);
      const auto found = test::mean_rest(Pfmc(hazy), wo, wi, technique, {2e-3, 0, 500, 50000}, rng);
      test::expect_agree(found, exact, 4.5, 3e-4, name + ", " + name_of(technique));
    }
  }
}

// 12 slabs x 2 techniques x 3 channels at 4.5 standard errors (7e-6): 5e-4 in all.
TEST(Slab, EvalIsReciprocal) {
  const Vec3 a = spherical_direction(0.4, 0), b = spherical_direction(1.2, 2);
  for (const auto& [name, material] : slabs())
    for (const Technique technique : kTechniques) {
      const LiveBsdf bsdf(material, Wavelengths::rgb3(material), technique);
      const auto gap = test::reciprocity_gap(bsdf, a, b, 2000, 8);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(gap[c].mean(), 0, 4.5 * gap[c].std_error() + 1e-12) << name << " channel " << c;
    }
}

// Samples follow the density, heroes or not. 6 slabs x 2 spectra, 1e-3 in all.
TEST(Slab, SamplesFollowThePdf) {
  auto some = slabs();
  for (std::size_t i = some.size(); i-- > 0;)
    if (i % 2 == 0) some.erase(some.begin() + static_cast<std::ptrdiff_t>(i));
  for (const auto& [name, material, wavelengths] : test::in_both_spectra(some)) {
    const auto options = is_peaked(material)
                             ? test::ChiSquareOptions{.polar = 3,
                                                      .azimuthal = 6,
                                                      .samples = 40000,
                                                      .points = 8,
                                                      .pdf_samples = 16}
                             : test::ChiSquareOptions{.samples = 40000, .points = 2, .pdf_samples = 16};
    const auto result = test::chi_square_of_sampling(LiveBsdf(material, wavelengths),
                                                     spherical_direction(0.9, 0.4), options, 9);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 12)) << name;
    EXPECT_GE(result.degrees, is_peaked(material) ? 15 : 100) << name;
  }
}

// Forward peaks do not make fireflies: of 2000 estimates none is above 25 times their mean, or 100 times at
// grazing, where few and short connections make up the value (of 20000: 11 and 36).
TEST(Slab, NoFireflies) {
  const Vec3 wi = spherical_direction(0.7, 0);
  const Vec3 out[] = {spherical_direction(0.7, 0), spherical_direction(0.7, kPi),
                      spherical_direction(1.4, kPi), spherical_direction(0.1, 1)};
  for (const double roughness : {0.0, 0.3})
    for (const auto transmission : {Transmission::straight, Transmission::refract}) {
      const Pfmc pfmc(slab(roughness, transmission, 10, 0.95, 0));
      for (const Vec3& wo : out) {
        Rng rng(11, 0);
        test::RunningMean mean;
        double largest = 0;
        for (int i = 0; i < 2000; ++i) {
          const double value = pfmc.estimate_rest(wo, wi, rng, Technique::bidirectional).r;
          mean.add(value);
          largest = std::max(largest, value);
        }
        EXPECT_LT(largest, (wo.z > 0.5 ? 25 : 100) * mean.mean())
            << roughness << ' ' << to_string(transmission) << ' ' << wo.z;
      }
    }
}

}  // namespace
}  // namespace sunbeam
