// eval, sample, pdf and albedo of factored tables agree with each other and with what is known exactly.
#include "tests/accuracy/factored/support.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

using test::FactoredTable;

// Between all nodes.
TableBsdf between_nodes(const Table& table) { return TableBsdf(table, {433, 1.15, 0.21}); }

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const Vec3 kSteep = spherical_direction(0.3, 2.5);
const Vec3 kGrazing = spherical_direction(1.4, 5);

// 14 rows x 3 directions, false alarm 1e-3 in all.
TEST_P(FactoredTable, SamplesFollowThePdf) {
  const TableBsdf table = between_nodes(this->table());
  for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
    const auto result = test::chi_square_of_sampling(table, wo, {.samples = 100000, .pdf_samples = 16}, 1);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 42)) << wo.z;
    EXPECT_GT(result.degrees, 50) << wo.z;
  }
}

// Sampled against integrated albedo, the Dirac included: 14 rows x 2 directions at 4.5 standard errors, 2e-4
// in all. Quadrature is good to 1e-4.
TEST_P(FactoredTable, SampledAlbedoIsTheAlbedo) {
  const TableBsdf table = between_nodes(this->table());
  for (const Vec3& wo : {kOblique, kSteep}) {
    const auto sampled = test::sample_totals(table, wo, 100000, 2).albedo.grey;
    const double albedo = mean(table.albedo(wo));
    EXPECT_LT(sampled.std_error(), 3e-3 * albedo) << wo.z;
    EXPECT_LT(test::deviation(sampled.mean(), sampled.std_error(), albedo, 0, 1e-4 * albedo), 4.5) << wo.z;
  }
}

// Lists of every length modulo four, lights at and below the horizon among them, and nothing written beyond.
TEST_P(FactoredTable, ListsOfLightsAreEvaluatedAsSingleOnes) {
  const TableBsdf table = between_nodes(this->table());
  Rng rng(4, 0);
  for (std::size_t count = 0; count < 40; ++count) {
    const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    std::vector<Vec3> wi;
    for (std::size_t k = 0; k < count; ++k) wi.push_back(sample_sphere({rng.uniform(), rng.uniform()}));
    if (count > 20) wi[7] = {1, 0, 0};
    const Rgb beyond(123);
    std::vector<Rgb> f(count + 1, beyond);
    table.eval(wo, wi, std::span(f).first(count));
    for (std::size_t k = 0; k < count; ++k) {
      const Rgb expected = table.eval(wo, wi[k], rng);
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(f[k][c], expected[c], 1e-5 * std::abs(expected[c]) + 1e-7) << wo.z << ' ' << wi[k].z;
    }
    EXPECT_EQ(f[count], beyond);
    table.eval({wo.x, wo.y, -wo.z}, wi, std::span(f).first(count));
    for (std::size_t k = 0; k < count; ++k) EXPECT_EQ(f[k], Rgb());
  }
}

// Throughput is f cos / pdf of the whole; a Dirac's its weight over what the rest of the density leaves.
TEST_P(FactoredTable, ThroughputIsEvalOverPdf) {
  const TableBsdf table = between_nodes(this->table());
  Rng rng(3, 0);
  int seen = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const auto s = table.sample(wo, rng);
    if (!s || s->is_dirac) continue;
    ++seen;
    const Rgb expected = table.eval(wo, s->wi, rng) * (s->wi.z / table.pdf(wo, s->wi, rng));
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(s->throughput[c], expected[c], 1e-5 * std::abs(expected[c])) << wo.z << ' ' << s->wi.z;
  }
  EXPECT_GT(seen, 2000);
}

// Two floats are multiplied in another order: 1e-5 is a hundred roundings.
TEST_P(FactoredTable, IsReciprocal) {
  const TableBsdf table = between_nodes(this->table());
  Rng rng(4, 0);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 a = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Vec3 b = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Rgb ab = table.eval(a, b, rng), ba = table.eval(b, a, rng);
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(ab[c], ba[c], 1e-5 * std::abs(ab[c])) << a.z << ' ' << b.z << ' ' << GetParam().name();
  }
}

INSTANTIATE_TEST_SUITE_P(Each, FactoredTable, ::testing::ValuesIn(test::all_rows()), test::name_of_row);

// A clear pigment over a white base under a film that absorbs nothing returns all light: albedo 1 in every
// direction, for a smooth film, which loses nothing between its facets. 1e-3 is interpolation; 3e-3 with path
// "product", whose exchange has few nodes a fringe (2e-3 where resonances at grazing make it kink).
TEST(FactoredFurnace, SmoothClearWhite) {
  for (const test::FilmRow& row : test::plain_rows())
    for (const char* spectrum : {"rgb3", "full"}) {
      if (!row.is_smooth()) continue;
      const Table& table = test::factored(row, spectrum, {"material.albedo=1", "grid.absorption_per_nm=[0]"});
      for (const double thickness : {0.0, 123.0, 500.0, 1499.0})
        for (const double ior : {1.0, 1.03, 1.37, 1.99}) {
          const TableBsdf bsdf(table, {thickness, ior, 0});
          for (const double cosine : {1.0, 0.7, 0.3, 0.1}) {
            const Rgb albedo = bsdf.albedo(direction_from_cosine(cosine, 0));
            for (int c = 0; c < 3; ++c)
              EXPECT_NEAR(albedo[c], 1, row.path == "sum" ? 1e-3 : 3e-3)
                  << row.name() << ' ' << spectrum << ' ' << thickness << ' ' << ior << ' ' << cosine;
          }
        }
    }
}

}  // namespace
}  // namespace sunbeam
