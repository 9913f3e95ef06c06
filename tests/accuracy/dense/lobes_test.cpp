// Which lobes a dense table can hold: what is refused says what is allowed, and what is allowed passes.
#include "bake/dense/lobes.h"

#include <gmock/gmock.h>

#include "sunbeam/core/error.h"
#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

std::string refusal(const std::string& material, const std::string& table = "") {
  const Recipe recipe = parse_recipe("[material]\n" + material + "\n[table]\n" + table, "narrow.toml");
  return test::error_of([&] { require_wide_lobes(recipe); });
}

std::string facets(double alpha) { return "microfacet = \"multiple\"\nroughness = " + std::to_string(alpha); }

// scattering_depth() = 1.
std::string slab(double g, const std::string& more = "roughness = 0") {
  return "scattering_per_nm = 0.5\nanisotropy = " + std::to_string(g) + "\n" + more;
}

TEST(Lobes, OfFewFacetsOrBroadPhaseFunctionsPass) {
  EXPECT_EQ(refusal("roughness = 0.001"), "");
  EXPECT_EQ(refusal("microfacet = \"multiple\"\nroughness = 0"), "");
  for (const double alpha : {0.1, 0.2, 0.5, 1.0}) EXPECT_EQ(refusal(facets(alpha)), "") << alpha;
  for (const double g : {-0.8, -0.5, 0.0, 0.5, 0.99}) EXPECT_EQ(refusal(slab(g)), "") << g;
}

TEST(Lobes, OfFacetsNeedAzimuths) {
  for (const double alpha : {0.001, 0.003, 0.01, 0.02, 0.05, 0.08})
    EXPECT_THAT(refusal(facets(alpha)),
                ::testing::StartsWith("narrow.toml: key 'table.azimuths': found 9, which cannot hold the "
                                      "lobes of microfacet \"multiple\"; allowed with roughness 0.0"));
  EXPECT_THAT(refusal(facets(0.05)), ::testing::EndsWith("allowed with roughness 0.05: 31 to 512"));
  EXPECT_THAT(refusal(facets(0.05), "azimuths = 30"), ::testing::HasSubstr("found 30"));
  EXPECT_EQ(refusal(facets(0.05), "azimuths = 31"), "");
  for (const double alpha : {0.001, 0.003, 0.01, 0.0155, 0.02})  // none is out of reach
    EXPECT_EQ(refusal(facets(alpha), "azimuths = 110"), "") << alpha;
}

// Steps of 2 pi / azimuths, and the narrower of two lobes counts.
TEST(Lobes, OfAnisotropicFacetsNeedAzimuths) {
  const std::string film = "microfacet = \"multiple\"\nroughness = [0.5, 0.05]";
  EXPECT_THAT(refusal(film, "azimuths = 56"), ::testing::EndsWith("roughness 0.5;0.05: 60 to 512"));
  EXPECT_EQ(refusal(film, "azimuths = 60"), "");
}

TEST(Lobes, OfLightSentBackNeedAngles) {
  EXPECT_EQ(refusal(slab(-0.95)),
            "narrow.toml: key 'material.anisotropy': found -0.95, whose lobe 12 cosines cannot hold; allowed "
            "with them: -0.85 to 0.99 (table.angles sets their number)");
  EXPECT_EQ(refusal(slab(-0.85)), "");
  EXPECT_NE(refusal(slab(-0.9)), "");
  EXPECT_EQ(refusal(slab(-0.9), "angles = 40"), "");
}

// A pigment that scatters little has little in its lobe, and facets that bend light widen it.
TEST(Lobes, OfLightSentBackMayBeWeakOrWidened) {
  EXPECT_EQ(refusal("scattering_per_nm = 0.02\nroughness = 0\nanisotropy = -0.9"), "");
  EXPECT_EQ(refusal(slab(-0.99, "roughness = 0.3")), "");
  EXPECT_NE(refusal(slab(-0.99, "roughness = 0.1")), "");
  EXPECT_NE(refusal(slab(-0.99, "roughness = 0.3\ntransmission = \"straight\"")), "");
  EXPECT_NE(refusal(slab(-0.99, "roughness = 0.3\n[grid]\nbase_ior = [1, 1.5]")), "");
}

}  // namespace
}  // namespace sunbeam
