// The BSDF of synthetic tables: parameters, probabilities and degenerate content. No bake, no noise.
#include "sunbeam/table_bsdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/bsdf_checks.h"
#include "tests/support/quadrature.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

using test::small_table;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Parameters kBetween{260, 1.46, 0.1};
const Vec3 kOblique = spherical_direction(0.9, 0.4);

void fill(NdArray& array, double value) {
  for (std::size_t cell = 0; cell < array.cells(); ++cell) array.set(cell, Rgb(value));
}

// A table whose film reflects `reflectance` and passes the rest, with a constant remainder.
Table constant_table(bool rough, double reflectance, double remainder, double albedo) {
  Table table = small_table(Precision::single_float, rough);
  table.material.albedo = Rgb(albedo);
  table.material.transmission = Transmission::straight;
  table.material.pigment_thickness_nm = 0;  // clear
  fill(table.film_reflectance, reflectance);
  if (rough) fill(table.film_transmittance, 1 - reflectance);
  fill(table.remainder, remainder);
  return table;
}

TEST(TableBsdf, ParametersOutsideTheGrid) {
  const Table table = small_table();
  const Parameters outside{150, 1.6, 0.1}, nearest{200, 1.5, 0.1};
  try {
    TableBsdf(table, outside);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("'film_thickness_nm'"), HasSubstr("150"), HasSubstr("200 to 400")));
  }
  EXPECT_THROW(TableBsdf(table, {300, 1.45, 0.2}), Error);
  EXPECT_NO_THROW(TableBsdf(table, nearest));
  const TableBsdf clamped(table, outside, {.outside = OutsideGrid::clamp}), inside(table, nearest);
  EXPECT_EQ(clamped.material().film_thickness_nm, 200);
  EXPECT_EQ(clamped.material().base_ior, 1.5);
  Rng rng(1, 0);
  for (int k = 0; k < 100; ++k) {
    const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    EXPECT_EQ(clamped.eval(kOblique, wi, rng), inside.eval(kOblique, wi, rng));
  }
}

// Half-way between thickness nodes the remainder is the mean of theirs: 0.1 and 0.3 give 0.2. A straight,
// clear, black table with T = 1 returns it.
TEST(TableBsdf, InterpolatesParameters) {
  Table table = constant_table(false, 0, 0, 0);
  const std::size_t stride = table.remainder.stride(0);
  for (std::size_t cell = 0; cell < table.remainder.cells(); ++cell)
    table.remainder.set(cell, Rgb(0.1 + 0.2 * static_cast<double>(cell / stride)));
  const TableBsdf bsdf(table, {250, 1.45, 0.1});
  EXPECT_NEAR(bsdf.rest(kOblique, spherical_direction(0.2, 3)).g, 0.2, 1e-7);
}

// Without a frame the array holds the rest itself, and no closed form is asked for.
TEST(TableBsdf, WithoutAFrameTheArrayIsTheRest) {
  Table table = constant_table(true, 0.3, 0.1, 0.5);
  table.frame = FrameKind::none;
  table.film_transmittance = NdArray();
  for (const auto& form : test::forms()) {
    const Table loaded = form.parse(form.bytes(table), "t");
    EXPECT_TRUE(loaded == table) << form.name;
    const TableBsdf bsdf(loaded, kBetween);
    EXPECT_NEAR(bsdf.rest(kOblique, spherical_direction(1.2, 2)).r, 0.1, 1e-7);
  }
}

// rest = T T (kd/pi + remainder) = 0.7^2 (0.5/pi + 0.1), albedo = R + pi rest for a smooth film.
TEST(TableBsdf, ConstantTableInClosedForm) {
  const TableBsdf bsdf(constant_table(false, 0.3, 0.1, 0.5), kBetween);
  const double rest = 0.49 * (0.5 * kInvPi + 0.1);
  EXPECT_NEAR(bsdf.rest(kOblique, spherical_direction(1.2, 2)).r, rest, 1e-7);
  EXPECT_NEAR(bsdf.albedo(kOblique).r, 0.3 + kPi * rest, 1e-6);
  EXPECT_NEAR(bsdf.dirac(kOblique).b, 0.3, 1e-7);
  Rng rng(1, 0);
  EXPECT_EQ(bsdf.first(kOblique, {-kOblique.x, -kOblique.y, kOblique.z}), Rgb(0));
}

TEST(TableBsdf, NothingBelowTheHorizon) {
  for (const bool rough : {false, true}) {
    const TableBsdf bsdf(small_table(Precision::half_float, rough), kBetween);
    Rng rng(2, 0);
    for (const Vec3& below : {spherical_direction(2, 1), Vec3{1, 0, 0}}) {
      EXPECT_EQ(bsdf.eval(kOblique, below, rng), Rgb(0));
      EXPECT_EQ(bsdf.eval(below, kOblique, rng), Rgb(0));
      EXPECT_EQ(bsdf.pdf(kOblique, below, rng), 0);
      EXPECT_EQ(bsdf.pdf(below, kOblique, rng), 0);
      EXPECT_FALSE(bsdf.sample(below, rng));
    }
  }
}

struct Named {
  std::string name;
  Table table;
};

std::vector<Named> odd_tables() {
  return {{"random smooth", small_table(Precision::half_float, false)},
          {"random rough", small_table(Precision::half_float, true)},
          {"no film", constant_table(false, 0, 0.1, 0.5)},
          {"mirror", constant_table(false, 1, 0.1, 0.5)},
          {"black", constant_table(false, 0, 0, 0)},
          {"black rough", constant_table(true, 0, 0, 0)},
          {"rough mirror", constant_table(true, 1, 0, 0)},
          {"dark base", constant_table(true, 0.1, 0, 0)}};
}

// Int pdf + P(Dirac) + P(empty) = 1. The pdf is deterministic, so that 16 jittered grids of 200 x 200 know
// its integral; sampling adds a binomial error of at most 0.5 / sqrt(100000) = 1.6e-3. 8 tables x 4
// directions at 4.5 standard errors: 2e-4 in all.
TEST(TableBsdf, ProbabilitiesAddUpToOne) {
  for (const auto& [name, table] : odd_tables()) {
    const TableBsdf bsdf(table, kBetween);
    for (const double theta : {0.0, 0.9, 1.4, 1.55}) {
      const Vec3 wo = spherical_direction(theta, 1);
      const auto totals = test::sample_totals(bsdf, wo, 100000, 3);
      const auto integral = test::integrate_pdf(bsdf, wo, 200, 16, 3);
      EXPECT_LT(test::deviation(totals.seen.mean(), totals.seen.std_error(), integral.mean(),
                                integral.std_error(), 1e-6),
                4.5)
          << name << ' ' << theta;
      EXPECT_NEAR(totals.seen.mean() + totals.dirac + totals.empty, 1, 1e-12);
    }
  }
}

// Dirac or not: throughput times probability is the mirror's weight; a mirror without rest is always taken.
TEST(TableBsdf, DiracWeight) {
  for (const double reflectance : {0.2, 1.0}) {
    const TableBsdf bsdf(constant_table(false, reflectance, 0.1, 0.5), kBetween);
    const auto totals = test::sample_totals(bsdf, kOblique, 50000, 4);
    Rng rng(4, 0);
    std::optional<BsdfSample> mirror;
    while (!mirror || !mirror->is_dirac) mirror = bsdf.sample(kOblique, rng);
    EXPECT_LT(length(mirror->wi - Vec3{-kOblique.x, -kOblique.y, kOblique.z}), 1e-15);
    const double chance = reflectance / mirror->throughput.g;
    EXPECT_NEAR(totals.dirac, chance, 4.5 * 0.5 / std::sqrt(50000.0));
    if (reflectance == 1) {
      EXPECT_NEAR(chance, 1, 1e-12);
    }
  }
}

// 8 tables, false alarm 1e-4 in all.
TEST(TableBsdf, SamplesFollowThePdf) {
  for (const auto& [name, table] : odd_tables()) {
    if (name == "mirror") continue;  // nothing but the Dirac
    const TableBsdf bsdf(table, kBetween);
    const auto result = test::chi_square_of_sampling(bsdf, kOblique, {.samples = 100000}, 5);
    EXPECT_GT(result.p_value, test::sidak(1e-4, 7)) << name;
    EXPECT_GT(result.degrees, 50) << name;
  }
}

// Directions at the horizon, at the pole and anywhere: finite, not negative, throughput = f cos / pdf.
TEST(TableBsdf, SoundEverywhere) {
  for (const auto& [name, table] : odd_tables()) {
    const TableBsdf bsdf(table, kBetween);
    Rng rng(6, 0);
    for (const double cosine : {1.0, 0.5, 1e-3, 1e-6, 1e-12}) {
      const Vec3 wo = direction_from_cosine(cosine, 2);
      const Rgb albedo = bsdf.albedo(wo);
      ASSERT_TRUE(is_finite(albedo)) << name << ' ' << cosine;
      for (int k = 0; k < 2000; ++k) {
        const auto s = bsdf.sample(wo, rng);
        if (!s) continue;
        ASSERT_TRUE(is_finite(s->throughput)) << name << ' ' << cosine;
        ASSERT_GE(std::min({s->throughput.r, s->throughput.g, s->throughput.b}), 0);
        ASSERT_NEAR(length(s->wi), 1, 1e-12);
        ASSERT_GT(s->wi.z, 0);
        if (s->is_dirac) continue;
        const double pdf = bsdf.pdf(wo, s->wi, rng);
        ASSERT_GT(pdf, 0);
        const Rgb expected = bsdf.eval(wo, s->wi, rng) * (s->wi.z / pdf);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(s->throughput[c], expected[c], 1e-12 * expected[c]);
      }
    }
  }
}

TEST(TableBsdf, EvalAndSampleIsEvalPdfAndThenSample) {
  for (const auto& [name, table] : odd_tables())
    EXPECT_LT(test::difference_together(TableBsdf(table, kBetween), 2000, 8), 1e-6) << name;
}

// eval and pdf are deterministic and leave the generator alone.
TEST(TableBsdf, UsesNoRandomNumbersToEvaluate) {
  const TableBsdf bsdf(small_table(), kBetween);
  Rng used(7, 0), fresh(7, 0);
  const Vec3 wi = spherical_direction(0.3, 2);
  EXPECT_EQ(bsdf.eval(kOblique, wi, used), bsdf.eval(kOblique, wi, used));
  EXPECT_EQ(bsdf.pdf(kOblique, wi, used), bsdf.mis_pdf(kOblique, wi));
  EXPECT_EQ(used.next(), fresh.next());
}

}  // namespace
}  // namespace sunbeam
