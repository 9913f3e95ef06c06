// Textured parameters: the table bound to the same point is the reference, itself checked against live models
// elsewhere.
#include "sunbeam/textured_table.h"

#include <gmock/gmock.h>

#include "sunbeam/core/error.h"
#include "tests/accuracy/support.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

using test::SmallRecipe;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const Vec3 kSteep = spherical_direction(0.3, 2.5);
const Vec3 kGrazing = spherical_direction(1.4, 5);
const Parameters kPoint{430, 1.37, 0.13};

constexpr const char* kGrid =
    "film_thickness_nm = {from = 0, to = 700, count = 5}\nbase_ior = {from = 1, to = 2, count = 8}\n"
    "absorption_per_nm = {from = 0, to = 1, count = 8}\n";

Table factored(SmallRecipe recipe) {
  std::string text = recipe.text();
  text.replace(text.find("\"dense\""), 7, "\"factored\"");
  return bake_table(parse_recipe(text, "small.toml"), {.seed = 1, .threads = 0, .on_progress = {}});
}

struct Case {
  std::string name;
  SmallRecipe recipe;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

const Table& table_of(const Case& one) {
  static std::map<std::string, Table> cache;
  if (!cache.count(one.name)) cache[one.name] = factored(one.recipe);
  return cache.at(one.name);
}

class TexturedTables : public ::testing::TestWithParam<Case> {
 protected:
  const Table& table() const { return table_of(GetParam()); }
  TexturedTable textured() const { return TexturedTable(table()); }
};

Parameters random_parameters(const Table& table, Rng& rng) {
  std::array<double, 3> x;
  for (std::size_t k = 0; k < 3; ++k)
    x[k] = lerp(rng.uniform(), table.parameter_axis(k).low(), table.parameter_axis(k).high());
  return {x[0], x[1], x[2]};
}

double mean_abs(const Rgb& x) { return (std::abs(x.r) + std::abs(x.g) + std::abs(x.b)) / 3; }

// As bake/verify.h measures a table: Int |difference| cos / max(Int |f| cos, 0.002).
double error_at(const TexturedTable& textured, const Table& table, Rng& rng) {
  const Parameters at = random_parameters(table, rng);
  const TexturedTable::At bsdf = textured.at(at);
  const TableBsdf reference(table, at, OutsideGrid::refuse);
  const Vec3 wi = direction_from_cosine(lerp(rng.uniform(), std::cos(89 * kPi / 180), 1), 1);
  double difference = 0, total = 0;
  constexpr int kDraws = 256;
  for (int k = 0; k < kDraws; ++k) {
    const auto sample = reference.sample(wi, rng);
    if (!sample || sample->is_dirac) continue;
    const EvalPdf expected = reference.eval_pdf(sample->wi, wi);
    const double weight = sample->wi.z / reference.mis_pdf(wi, sample->wi) / kDraws;
    difference += weight * mean_abs(bsdf.eval_pdf(sample->wi, wi).f - expected.f);
    total += weight * mean_abs(expected.f);
  }
  return difference / std::max(total, 0.002);
}

TEST_P(TexturedTables, AgreeWithBoundTables) {
  const TexturedTable textured = this->textured();
  std::vector<double> errors;
  Rng rng(5, 0);
  for (int k = 0; k < 100; ++k) errors.push_back(error_at(textured, table(), rng));
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[50], 0.001);
  EXPECT_LT(errors[98], 0.01);
  RecordProperty("median", std::to_string(errors[50]));
  RecordProperty("p99", std::to_string(errors[98]));
}

// 6 tables x 3 directions, false alarm 1e-3 in all.
TEST_P(TexturedTables, SamplesFollowThePdf) {
  const TexturedTable textured = this->textured();
  const auto bsdf = textured.at(kPoint);
  for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
    const auto result = test::chi_square_of_sampling(bsdf, wo, {.samples = 100000, .pdf_samples = 16}, 1);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 18)) << wo.z;
    EXPECT_GT(result.degrees, 100) << wo.z;
  }
}

// Int pdf + P(Dirac) + P(empty) = 1; 4.5 standard errors, false alarm 6 x 3 x 7e-6 in all.
TEST_P(TexturedTables, ProbabilitiesAddUpToOne) {
  const TexturedTable textured = this->textured();
  const auto bsdf = textured.at(kPoint);
  for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
    const auto totals = test::sample_totals(bsdf, wo, 200000, 3);
    const auto integral = test::integrate_pdf(bsdf, wo, wo.z < 0.2 ? 800 : 200, 4, 3);
    EXPECT_LT(
        test::deviation(totals.seen.mean(), totals.seen.std_error(), integral.mean(), integral.std_error()),
        4.5)
        << wo.z;
  }
}

TEST_P(TexturedTables, ThroughputIsValueOverDensity) {
  const TexturedTable textured = this->textured();
  Rng rng(6, 0);
  for (int k = 0; k < 2000; ++k) {
    const auto bsdf = textured.at(random_parameters(table(), rng));
    const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const auto sample = bsdf.sample(wo, rng);
    if (!sample) continue;
    if (sample->is_dirac) {
      const Rgb weight = bsdf.dirac(wo);  // chance = weight / throughput, the same in every channel
      EXPECT_EQ(sample->wi.z, wo.z);
      EXPECT_NEAR(sample->throughput.r * weight.g, sample->throughput.g * weight.r, 1e-5);
      continue;
    }
    const EvalPdf at = bsdf.eval_pdf(wo, sample->wi);
    ASSERT_GT(at.pdf, 0);
    const Rgb expected = at.f * (sample->wi.z / at.pdf);
    EXPECT_NEAR(mean_abs(sample->throughput - expected), 0, 1e-5 * (1e-6 + mean_abs(expected)));
  }
}

// Facets turn the estimate of a very rough film.
TEST_P(TexturedTables, AlbedoEstimateIsNear) {
  const TexturedTable textured = this->textured();
  for (const Vec3& wo : {kOblique, kSteep}) {
    const double expected = mean(TableBsdf(table(), kPoint, OutsideGrid::refuse).albedo(wo));
    EXPECT_NEAR(textured.at(kPoint).albedo(wo), expected, 0.2 * expected) << wo.z;
  }
}

TEST_P(TexturedTables, Reciprocal) {
  const TexturedTable textured = this->textured();
  Rng rng(7, 0);
  for (int k = 0; k < 2000; ++k) {
    const auto bsdf = textured.at(random_parameters(table(), rng));
    const Vec3 a = test::uniform_hemisphere({rng.uniform(), rng.uniform()}),
               b = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Rgb forward = bsdf.eval(a, b, rng), backward = bsdf.eval(b, a, rng);
    EXPECT_NEAR(mean_abs(forward - backward), 0, 1e-5 * (1e-3 + mean_abs(forward)));
  }
}

TEST_P(TexturedTables, ParametersOutsideTheGrid) {
  const TexturedTable textured = this->textured();
  const Parameters outside{900, 1.2, 0.1}, nearest{700, 1.2, 0.1};
  Rng rng(8, 0);
  EXPECT_EQ(textured.at(outside).eval(kOblique, kSteep, rng),
            textured.at(nearest).eval(kOblique, kSteep, rng));
  EXPECT_EQ(textured.at({NAN, 1.2, 0.1}).parameters().film_thickness_nm, 700);
  EXPECT_NO_THROW(textured.at(nearest, OutsideGrid::refuse));
  try {
    textured.at(outside, OutsideGrid::refuse);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("'film_thickness_nm'"), HasSubstr("900"), HasSubstr("0 to 700")));
  }
}

SmallRecipe recipe_of(double roughness, const std::string& transmission, const std::string& spectrum) {
  SmallRecipe recipe;
  recipe.roughness = roughness;
  recipe.transmission = transmission;
  recipe.spectrum = spectrum;
  recipe.grid = kGrid;
  return recipe;
}

std::vector<Case> cases() {
  const std::string full = "mode = \"full\"\n";
  return {{"rough", recipe_of(0.1, "refract", full)},          {"smooth", recipe_of(0, "refract", full)},
          {"very_rough", recipe_of(0.5, "refract", full)},     {"straight", recipe_of(0.1, "straight", full)},
          {"straight_smooth", recipe_of(0, "straight", full)}, {"rgb3", recipe_of(0.2, "refract", "")}};
}
INSTANTIATE_TEST_SUITE_P(, TexturedTables, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

std::string refusal(const Table& table) {
  try {
    TexturedTable refused(table);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TexturedTable, NamesWhatIsNotSupported) {
  EXPECT_THAT(refusal(test::baked({})), HasSubstr("dense"));
  SmallRecipe product;
  product.path = "product";
  EXPECT_THAT(refusal(factored(product)), HasSubstr("product"));
}

// One node of every parameter.
TEST(TexturedTable, OnePoint) {
  const Table table = factored({});
  Rng rng(9, 0);
  EXPECT_LT(error_at(TexturedTable(table), table, rng), 0.001);
}

}  // namespace
}  // namespace sunbeam
