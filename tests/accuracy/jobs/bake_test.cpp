// The bake as a function of recipe and seed.
#include "bake/base/version.h"
#include "sunbeam/table_io.h"
#include "sunbeam/table_vdb.h"
#include "tests/accuracy/support.h"

namespace sunbeam {
namespace {

test::SmallRecipe gridded() {
  test::SmallRecipe recipe;
  recipe.grid = "film_thickness_nm = [300, 330, 360]\nabsorption_per_nm = [0.1, 0.2]";
  recipe.cosines = 6;
  recipe.noise = 0.03;
  return recipe;
}

Table bake(const test::SmallRecipe& recipe, std::uint64_t seed, int threads) {
  return bake_table(recipe.recipe(), {.seed = seed, .threads = threads, .on_progress = {}});
}

TEST(Bake, SameBitsForEveryThreadCount) {
  const Table one = bake(gridded(), 1, 1), two = bake(gridded(), 1, 2), all = bake(gridded(), 1, 0);
  EXPECT_TRUE(one == two);
  EXPECT_TRUE(one == all);
  EXPECT_TRUE(table_exr_bytes(one) == table_exr_bytes(two));
  EXPECT_TRUE(table_vdb_bytes(one) == table_vdb_bytes(two));
}

TEST(Bake, OtherSeedOtherNoise) {
  const Table one = bake(gridded(), 1, 0), other = bake(gridded(), 2, 0);
  EXPECT_FALSE(one.remainder == other.remainder);
  EXPECT_TRUE(one.film_reflectance == other.film_reflectance);  // closed form
  EXPECT_TRUE(one.film_transmittance == other.film_transmittance);
}

// The same random numbers at every parameter node: neighbours differ by far less than their noise, so that a
// slider moves without ripples. Independent noise would differ by 1.4 standard errors, root mean square; what
// a nanometre of film changes is in it.
TEST(Bake, NeighboursShareTheirNoise) {
  test::SmallRecipe recipe = gridded();
  recipe.grid = "film_thickness_nm = [300, 301]";
  const Table table = bake(recipe, 1, 0);
  const std::size_t stride = table.remainder.stride(0);
  const TableBsdf a(table, {300, recipe.base_ior, recipe.absorption_per_nm});
  const TableBsdf b(table, {301, recipe.base_ior, recipe.absorption_per_nm});
  double sum = 0;
  int count = 0;
  for (const double c : table.remainder.axes()[3].nodes)
    for (const double d : table.remainder.axes()[5].nodes) {
      const Vec3 wo = direction_from_cosine(c, 0), wi = direction_from_cosine(d, 0);
      const double error = mean(a.rest_stderr(wo, wi));
      sum += square(mean(a.rest(wo, wi) - b.rest(wo, wi)) / error);
      ++count;
    }
  EXPECT_LT(std::sqrt(sum / count), 0.5) << "over " << stride << " cells";
}

TEST(Bake, InfoIsComplete) {
  const Table table = bake(gridded(), 5, 0);
  EXPECT_EQ(table.info.at("seed"), "5");
  EXPECT_EQ(table.info.at("estimator"), "pfmc-unidirectional");
  EXPECT_EQ(table.info.at("spectrum"), "rgb3");
  EXPECT_EQ(table.info.at("encoding"), "dense");
  EXPECT_EQ(table.info.at("tool_version"), kToolVersion);
  EXPECT_EQ(table.info.at("recipe_hash"), gridded().recipe().hash);
  // 6 nodes x 6 rows of at least 512 walks; the recipe in the table is the recipe.
  EXPECT_GE(std::stoull(table.info.at("samples")), 6u * 6u * 512u);
  EXPECT_EQ(parse_recipe(table.info.at("recipe"), "again").hash, table.info.at("recipe_hash"));
}

TEST(Bake, SurvivesBothFileForms) {
  const Table table = bake(gridded(), 1, 0);
  EXPECT_TRUE(parse_table_exr(table_exr_bytes(table), "t") == table);
  EXPECT_TRUE(parse_table_vdb(table_vdb_bytes(table), "t") == table);
}

// Half precision changes every value by at most 2^-11 of it (or half the smallest half, 3e-8).
TEST(Bake, HalvesAreTheSameValuesRounded) {
  const Table single = bake(gridded(), 1, 0);
  const Table half = bake_table(parse_recipe(gridded().text(), "half", {"table.precision=half"}),
                                {.seed = 1, .threads = 0, .on_progress = {}});
  ASSERT_EQ(half.remainder.precision(), Precision::half_float);
  const auto a = single.remainder.values(), b = half.remainder.values();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], 0x1p-11 * std::abs(a[k]) + 3e-8);
}

// A rest without any azimuth, baked with three: the same in all of them, to noise.
TEST(Bake, AzimuthsOfAnIsotropicFilmAgree) {
  const Table table = bake_table(parse_recipe(gridded().text(), "azimuths", {"table.azimuths=3"}),
                                 {.seed = 1, .threads = 0, .on_progress = {}});
  ASSERT_EQ(table.remainder.axes()[6].size(), 3u);
  const TableBsdf bsdf(table, {300, 1.4, 0.1});
  for (const double cosine : {0.208, 0.604, 1.0}) {
    const Vec3 wi = direction_from_cosine(cosine, 0);
    for (const double phi : {kPi / 2, kPi}) {
      const Vec3 straight = direction_from_cosine(0.802, 0), turned = direction_from_cosine(0.802, phi);
      const double error = std::hypot(bsdf.rest_stderr(straight, wi).g, bsdf.rest_stderr(turned, wi).g);
      // 6 pairs at 5 standard errors.
      EXPECT_NEAR(bsdf.rest(straight, wi).g, bsdf.rest(turned, wi).g, 5 * error) << cosine << ' ' << phi;
      EXPECT_GT(error, 0);
    }
  }
}

Recipe anisotropic() {
  test::SmallRecipe recipe = gridded();
  recipe.grid = "absorption_per_nm = [0.1, 0.2]";
  return parse_recipe(recipe.text(), "anisotropic",
                      {"material.roughness=[0.1, 0.4]", "table.angles=4", "table.azimuths=8"});
}

Table bake_anisotropic(int threads) {
  return bake_table(anisotropic(), {.seed = 1, .threads = threads, .on_progress = {}});
}

TEST(Bake, AzimuthsByMaterial) {
  const auto azimuths = [](const std::string& material) {
    return parse_recipe("[material]\n" + material, "r").table.azimuths;
  };
  EXPECT_EQ(azimuths(""), 1);
  EXPECT_EQ(azimuths("roughness = [0.2, 0.2]"), 1);
  EXPECT_EQ(azimuths("microfacet = \"multiple\"\nroughness = 0"), 1);
  EXPECT_EQ(azimuths("microfacet = \"multiple\""), 9);
  EXPECT_EQ(azimuths("scattering_per_nm = 0.5"), 9);
  EXPECT_EQ(azimuths("scattering_per_nm = 0.5\nroughness = [0.1, 0.2]"), 8);
  EXPECT_EQ(azimuths("roughness = [0.1, 0.2]\nabsorption_path = \"sum\""), 16);
  EXPECT_EQ(azimuths("roughness = [0.1, 0.2]\nabsorption_path = \"product\""), 12);
}

TEST(Bake, AnisotropicAxes) {
  const Table table = bake_anisotropic(0);
  EXPECT_EQ(table.symmetry, Symmetry::anisotropic);
  const Axis &phi_i = table.remainder.axes()[4], &phi_o = table.remainder.axes()[6];
  EXPECT_EQ(phi_i.nodes, (std::vector{0.0, kPi / 4, kPi / 2}));
  EXPECT_EQ(phi_i.period, 0);
  ASSERT_EQ(phi_o.size(), 8u);
  EXPECT_EQ(phi_o.nodes[1], kPi / 4);
  EXPECT_EQ(phi_o.period, 2 * kPi);
  EXPECT_TRUE(table == bake_anisotropic(1));
  EXPECT_TRUE(parse_table_exr(table_exr_bytes(table), "t") == table);
}

// Exchanged, mirrored in x or y, or turned about a direction along z: what is stored is equal to the last
// bit.
TEST(Bake, SymmetriesOfStoredValues) {
  const Table table = bake_anisotropic(0);
  const std::size_t cosines = 4, round = 8, quadrant = 3, node = table.remainder.stride(2);
  // Any azimuths, in steps from x: those of the cell, whose wi is in the first quadrant.
  const auto cell = [&](std::size_t i, std::size_t phi_i, std::size_t o, std::size_t phi_o) {
    if (phi_i > round / 2) phi_i = round - phi_i, phi_o = (round - phi_o) % round;
    if (phi_i > round / 4) phi_i = round / 2 - phi_i, phi_o = (round + round / 2 - phi_o) % round;
    return node + ((i * quadrant + phi_i) * cosines + o) * round + phi_o;
  };
  int different = 0;
  for (std::size_t i = 0; i < cosines; ++i)
    for (std::size_t phi_i = 0; phi_i < quadrant; ++phi_i)
      for (std::size_t o = 0; o < cosines; ++o)
        for (std::size_t phi_o = 0; phi_o < round; ++phi_o) {
          const std::size_t here = cell(i, phi_i, o, phi_o);
          std::vector<std::size_t> equal = {cell(o, phi_o, i, phi_i)};
          if (phi_i == 0) equal.push_back(cell(i, 0, o, (round - phi_o) % round));
          if (phi_i == round / 4) equal.push_back(cell(i, phi_i, o, (round + round / 2 - phi_o) % round));
          if (i == cosines - 1) equal.push_back(cell(i, 0, o, phi_o));
          if (o == cosines - 1) equal.push_back(cell(i, phi_i, o, 0));
          for (const std::size_t there : equal) {
            ASSERT_EQ(table.remainder.get(here), table.remainder.get(there)) << i << phi_i << o << phi_o;
            ASSERT_EQ(table.rest_stderr.get(here), table.rest_stderr.get(there));
          }
          different +=
              i == 0 && o == 0 && !(table.remainder.get(here) == table.remainder.get(cell(0, 0, 0, 0)));
        }
  EXPECT_GT(different, 0);
}

// |dphi| means nothing where a direction is along z.
TEST(Bake, AzimuthsOfAnIsotropicFilmAreOneAlongZ) {
  const Table table = bake_table(parse_recipe(gridded().text(), "azimuths", {"table.azimuths=3"}),
                                 {.seed = 1, .threads = 0, .on_progress = {}});
  for (std::size_t c = 0; c < 6; ++c)
    for (std::size_t a = 1; a < 3; ++a) {
      EXPECT_EQ(table.remainder.get((5 * 6 + c) * 3 + a), table.remainder.get((5 * 6 + c) * 3));
      EXPECT_EQ(table.remainder.get((c * 6 + 5) * 3 + a), table.remainder.get((5 * 6 + c) * 3));
    }
}

TEST(Bake, ReportsProgress) {
  std::vector<double> fractions;
  bake_table(gridded().recipe(),
             {.seed = 1, .threads = 2, .on_progress = [&](double f) { fractions.push_back(f); }});
  ASSERT_EQ(fractions.size(), 6u * 6u);  // parameter nodes x rows
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace sunbeam
