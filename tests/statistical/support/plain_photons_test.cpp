// The yardstick of layered films by itself: against the exact evaluator and the other plain walks where the
// film is one clear layer. Fixed seeds; the stated rates of false alarm hold when a seed is changed.
#include "tests/support/plain_photons.h"

#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "tests/support/materials.h"

namespace sunbeam {
namespace {

using test::Fate;

const Vec3 kOblique = spherical_direction(0.8, 0.3);
const test::CellGrid kGrid{.polar = 3, .azimuthal = 6};

test::PhotonCount count(const Material& material, int photons) {
  Rng rng(1, 0);
  return {material, Wavelengths::rgb3(material), kOblique, kGrid, photons, rng};
}

void expect_share(const test::PhotonCount& photons, std::initializer_list<Fate> fates, const Rgb& expected,
                  double slack, const std::string& what) {
  const Rgb found = photons.share(fates);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(found[c], expected[c], 4.5 * photons.error_of(expected[c]) + slack) << what << ' ' << c;
}

// 8 films, 3 albedos and 3 histograms each, of which the former at 4.5 standard errors (7e-6): 2e-4, and 1e-3
// for the latter.
TEST(PlainPhotons, AgreeWithTheExactEvaluatorUnderOneLayer) {
  for (const auto& [name, material] : test::all_modes()) {
    const ExactRest exact(material, Wavelengths::rgb3(material));
    const auto photons = count(material, 8000);
    expect_share(photons, {Fate::first, Fate::rest}, exact.albedo(kOblique), 1e-3, name);
    Rng rng(2, 0);
    const auto expected = test::integrate_cells(
        kGrid, 16, rng, [&](const Vec3& wo, Rng&) { return exact.rest(wo, kOblique) * wo.z; });
    EXPECT_GT(test::least_p_value(photons.cells(), expected), test::sidak(1e-3, 24)) << name;
    EXPECT_GE(test::compare_cells(photons.cells(), expected, 0).degrees, 12) << name;
  }
}

// Slabs and multiple facets against the walks that carry weights. 3 surfaces x 3 channels: 1e-3.
TEST(PlainPhotons, AgreeWithWalksThatCarryWeights) {
  for (const auto& [name, material] : test::general_modes()) {
    if (name != "multiple" && name != "multiple straight product" && name != "all") continue;
    Material m = material;
    m.absorption_path = AbsorptionPath::sum;
    const auto photons = count(m, 15000);
    Rng rng(3, 0);
    const auto expected =
        test::PlainFacetLayers(m, {650, 510, 475}).histogram(kOblique, kGrid, 30000, rng).cells();
    EXPECT_GT(test::least_p_value(photons.cells(), expected), test::sidak(1e-3, 9)) << name;
    EXPECT_GE(test::compare_cells(photons.cells(), expected, 0).degrees, 12) << name;
  }
}

// Nothing is lost from the account. Over white, without pigment, only single facets lose light.
TEST(PlainPhotons, ClearFilmsOverWhiteAbsorbNothing) {
  for (auto [name, m] : test::all_modes()) {
    m.albedo = Rgb(1);
    m.absorption_per_nm = 0;
    const auto photons = count(m, 500);
    const Rgb gone = photons.share({Fate::first, Fate::rest}), lost = photons.share({Fate::facets});
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(gone[c] + lost[c], 1, 1e-12) << name;
      EXPECT_EQ(lost[c] > 0, !m.is_smooth()) << name;
    }
  }
}

}  // namespace
}  // namespace sunbeam
