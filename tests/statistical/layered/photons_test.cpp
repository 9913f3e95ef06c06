// Layered films that absorb, and opaque bases, against photons that are counted one at a time
// (plain_photons.h). Fixed seeds; the stated rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/live_bsdf.h"
#include "tests/support/estimates.h"
#include "tests/support/layered_materials.h"
#include "tests/support/plain_photons.h"

namespace sunbeam {
namespace {

using test::Configuration;
using test::Fate;

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const test::CellGrid kGrid{.polar = 3, .azimuthal = 6};

test::PhotonCount count(const Configuration& c, int photons) {
  Rng rng(1, 0);
  return {c.material, c.wavelengths, kOblique, kGrid, photons, rng};
}

// How far shares of photons are from what the product says, in all and each.
struct Gaps {
  int tests;  // for the level of those over cells
  test::RunningMean gap, squared;

  void add(const test::PhotonCount& photons, std::initializer_list<Fate> fates, const test::RgbMean& found,
           const std::string& what) {
    const Rgb share = photons.share(fates);
    for (int c = 0; c < 3; ++c) {
      const double error = std::hypot(photons.error_of(share[c]), found[c].std_error());
      EXPECT_NEAR(found[c].mean(), share[c], 4.5 * error + 1e-9) << what << ", channel " << c;
      gap.add(found[c].mean() - share[c]);
      if (error > 0) squared.add(square((found[c].mean() - share[c]) / error));
    }
  }
};

test::RgbMean sampled_loss(const Configuration& c, int samples) {
  const LiveBsdf bsdf(c.material, c.wavelengths);
  Rng rng(2, 0);
  test::RgbMean loss;
  for (int i = 0; i < samples; ++i) {
    const auto s = bsdf.sample(kOblique, rng);
    if (s) {
      EXPECT_GT(s->wi.z, 0) << c.name;
      for (int k = 0; k < 3; ++k) EXPECT_GE(s->throughput[k], 0) << c.name;
    }
    loss.add(Rgb(1) - (s ? s->throughput : Rgb()));
  }
  return loss;
}

void expect_cells(const Configuration& c, const test::PhotonCount& photons, int points, int tests) {
  const Pfmc pfmc(c.material, c.wavelengths);
  for (const Technique technique : test::kTechniques) {
    Rng rng(3, 0);
    const auto found = test::integrate_cells(kGrid, points, rng, [&](const Vec3& wo, Rng& r) {
      return pfmc.estimate_rest(wo, kOblique, r, technique) * wo.z;
    });
    EXPECT_GT(test::least_p_value(photons.cells(), found), test::sidak(1e-3, tests))
        << c.name << ", " << test::name_of(technique);
  }
}

// What is missing from the albedo over a white base is what the photons' counter has, and the rest goes where
// the photons go.
void expect_losses(const std::vector<Configuration>& configurations, int photons, int points) {
  const int count_of = static_cast<int>(configurations.size());
  Gaps gaps{6 * count_of, {}, {}};
  for (const Configuration& c : configurations) {
    const auto counted = count(c, photons);
    const Rgb absorbed = counted.share({Fate::film});
    for (int k = 0; k < 3; ++k) EXPECT_GE(absorbed[k], 0.02) << c.name;
    gaps.add(counted, {Fate::film, Fate::facets}, sampled_loss(c, photons), c.name);
    expect_cells(c, counted, points, gaps.tests);
  }
  ::testing::Test::RecordProperty("mean_gap", std::to_string(gaps.gap.mean()));
  ::testing::Test::RecordProperty("deviation", std::to_string(std::sqrt(gaps.squared.mean())));
  EXPECT_LE(std::abs(gaps.gap.mean()), 4.5 * gaps.gap.std_error());
}

// Every film on every surface: 27 materials, 81 shares at 4.5 standard errors (6e-4) and their mean (1e-5),
// 162 histograms (1e-3).
TEST(LongLayeredPhotons, FindWhatFilmsAbsorb) {
  expect_losses(test::with_films(test::absorbing_designs(), test::film_surfaces(Rgb(1))), 60000, 1000);
}

// Every surface once: 9 materials, 27 shares (2e-4) and 54 histograms (1e-3).
TEST(LayeredPhotons, FindWhatFilmsAbsorb) {
  const auto designs = test::absorbing_designs();
  std::vector<Configuration> some;
  for (const auto& surface : test::film_surfaces(Rgb(1)))
    some.push_back(test::with_film(designs[some.size() % 3], surface));
  expect_losses(some, 8000, 200);
}

// Pigments, coloured bases and slabs below: of both kinds what leaves is compared as well. 5 materials, 15
// shares (1e-4) and 30 histograms (1e-3).
TEST(LayeredPhotons, AgreeOverPigments) {
  std::vector<test::NamedMaterial> bare;
  for (const auto& surface : test::film_surfaces({0.9, 0.8, 0.6}, 0.15))
    if (surface.name == "smooth refract" || surface.name == "rough refract" ||
        surface.name == "multiple straight" || surface.name == "rough straight" ||
        surface.name == "multiple refract")
      bare.push_back(surface);
  for (std::size_t i = 0; i < bare.size(); ++i) {
    Material& m = bare[i].material;
    if (i % 2 == 0) {
      m.absorption_path = AbsorptionPath::product;
    } else {
      m.scattering_per_nm = 0.7 / m.pigment_thickness_nm;
      m.anisotropy = 0.4;
    }
  }
  Gaps gaps{30, {}, {}};
  for (const auto& c : test::with_films({test::absorbing_design()}, bare)) {
    const auto photons = count(c, 10000);
    gaps.add(photons, {Fate::film, Fate::facets, Fate::pigment, Fate::base}, sampled_loss(c, 10000), c.name);
    expect_cells(c, photons, 200, gaps.tests);
  }
}

std::vector<Configuration> opaque_configurations() {
  return test::with_films(test::opaque_designs(), test::film_surfaces(Rgb(1)));
}

// An opaque base sends nothing back.
TEST(LayeredPhotons, NothingReturnsFromAnOpaqueBase) {
  for (const auto& [name, material, wavelengths] : opaque_configurations()) {
    EXPECT_FALSE(material.defect()) << name;
    if (material.has_multiple_facets()) continue;
    const Pfmc pfmc(material, wavelengths);
    Rng rng(4, 0);
    for (const Technique technique : test::kTechniques)
      for (int i = 0; i < 200; ++i) {
        const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
        const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
        ASSERT_TRUE(is_black(pfmc.estimate_rest(wo, wi, rng, technique))) << name;
      }
  }
}

// All that comes back is first, or has wandered among multiple facets. 18 materials: 108 shares (8e-4), and
// 36 histograms (1e-3).
TEST(LayeredPhotons, AgreeOverOpaqueBases) {
  Gaps gaps{36, {}, {}}, first{36, {}, {}};
  for (const Configuration& c : opaque_configurations()) {
    const auto photons = count(c, 6000);
    const auto loss = sampled_loss(c, 6000);
    gaps.add(photons, {Fate::film, Fate::facets, Fate::base}, loss, c.name);
    for (int k = 0; k < 3; ++k) EXPECT_GE(loss[k].mean(), 0) << c.name;
    if (c.material.has_multiple_facets()) {
      expect_cells(c, photons, 200, gaps.tests);
      continue;
    }
    test::RgbMean reflected;
    const Pfmc pfmc(c.material, c.wavelengths);
    Rng rng(5, 0);
    for (const Rgb& total : test::integrate_stratified(
             24, 8, rng, [&](const Vec3&wi, Rng&) { return pfmc.first(kOblique, wi) * wi.z; }))
      reflected.add(total + pfmc.dirac(kOblique));
    first.add(photons, {Fate::first}, reflected, c.name);
  }
  EXPECT_LE(std::abs(gaps.gap.mean()), 4.5 * gaps.gap.std_error());
  EXPECT_LE(std::abs(first.gap.mean()), 4.5 * first.gap.std_error());
}

}  // namespace
}  // namespace sunbeam
