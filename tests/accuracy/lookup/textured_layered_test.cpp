// Textured parameters under layered films: the table bound to the same point is the reference, itself checked
// against live models elsewhere.
#include <gmock/gmock.h>

#include "bake/check/verify.h"
#include "sunbeam/core/error.h"
#include "sunbeam/textured_table.h"
#include "tests/accuracy/support.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/textured_errors.h"

namespace sunbeam {
namespace {

using ::testing::HasSubstr;

// The lines of a recipe.
struct Case {
  std::string name, material, layers, grid;
  std::string mode = "full";
  double p99 = 0.005;
  int points = 40;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

std::string layer(double thickness_nm, double ior, double extinction = 0) {
  return "[[material.film]]\nthickness_nm = " + to_text(thickness_nm) + "\nior = " + to_text(ior) +
         "\nextinction = " + to_text(extinction) + "\n";
}

Table baked(const Case& one) {
  const std::string text = "[material]\n" + one.material + one.layers + "[grid]\n" + one.grid +
                           "[spectrum]\nmode = \"" + one.mode +
                           "\"\n[table]\nencoding = \"factored\"\n[accuracy]\nnoise = 0.01\n";
  return bake_table(parse_recipe(text, "layered.toml"), {.seed = 1, .threads = 0, .on_progress = {}});
}

const Table& table_of(const Case& one) {
  static std::map<std::string, Table> cache;
  if (!cache.count(one.name)) cache[one.name] = baked(one);
  return cache.at(one.name);
}

constexpr int kCases = 16;

class TexturedLayeredTables : public ::testing::TestWithParam<Case> {
 protected:
  const Table& table() const { return table_of(GetParam()); }
  const TexturedTable& textured() const {
    static std::map<std::string, TexturedTable> cache;
    return cache.try_emplace(GetParam().name, table()).first->second;
  }
};

TEST_P(TexturedLayeredTables, AgreeWithBoundTables) {
  const std::vector<double> errors = test::sorted_errors(textured(), table(), GetParam().points);
  const double median = errors[errors.size() / 2], p99 = errors[errors.size() - 2];
  EXPECT_LT(median, 0.001);
  EXPECT_LT(p99, GetParam().p99);
  RecordProperty("median", std::to_string(median));
  RecordProperty("p99", std::to_string(p99));
}

// R and P have up to 8 MB each, X up to 12.
TEST_P(TexturedLayeredTables, TakeLittleMemory) { EXPECT_LT(textured().bytes(), 32e6); }

// False alarm 1e-3 in all.
TEST_P(TexturedLayeredTables, SamplesFollowThePdf) {
  Rng rng(5, 0);
  const auto bsdf = textured().at(test::random_parameters(table(), rng));
  const auto result = test::chi_square_of_sampling(bsdf, spherical_direction(0.9, 0.4),
                                                   {.samples = 30000, .pdf_samples = 16}, 1);
  EXPECT_GT(result.p_value, test::sidak(1e-3, kCases));
}

TEST_P(TexturedLayeredTables, ThroughputIsValueOverDensity) {
  Rng rng(6, 0);
  for (int k = 0; k < 500; ++k) {
    const auto bsdf = textured().at(test::random_parameters(table(), rng));
    const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const auto sample = bsdf.sample(wo, rng);
    if (!sample || sample->is_dirac) continue;
    const EvalPdf at = bsdf.eval_pdf(wo, sample->wi);
    ASSERT_GT(at.pdf, 0);
    const Rgb expected = at.f * (sample->wi.z / at.pdf);
    EXPECT_NEAR(test::mean_abs(sample->throughput - expected), 0, 1e-5 * (1e-6 + test::mean_abs(expected)));
  }
}

TEST_P(TexturedLayeredTables, Reciprocal) {
  Rng rng(7, 0);
  for (int k = 0; k < 500; ++k) {
    const auto bsdf = textured().at(test::random_parameters(table(), rng));
    const Vec3 a = test::uniform_hemisphere({rng.uniform(), rng.uniform()}),
               b = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Rgb forward = bsdf.eval(a, b, rng), backward = bsdf.eval(b, a, rng);
    EXPECT_NEAR(test::mean_abs(forward - backward), 0, 1e-5 * (1e-3 + test::mean_abs(forward)));
  }
}

// 4.5 standard errors, false alarm 16 x 2 x 7e-6 in all.
TEST_P(TexturedLayeredTables, ProbabilitiesAddUpToOne) {
  Rng rng(9, 0);
  const auto bsdf = textured().at(test::random_parameters(table(), rng));
  for (const Vec3& wo : {spherical_direction(0.9, 0.4), spherical_direction(0.3, 2.5)}) {
    const auto totals = test::sample_totals(bsdf, wo, 100000, 3);
    const auto integral = test::integrate_pdf(bsdf, wo, 200, 4, 3);
    EXPECT_LT(
        test::deviation(totals.seen.mean(), totals.seen.std_error(), integral.mean(), integral.std_error()),
        4.5)
        << wo.z;
  }
}

TEST_P(TexturedLayeredTables, AlbedoEstimateIsNear) {
  Rng rng(11, 0);
  const Parameters at = test::random_parameters(table(), rng);
  const Vec3 wo = spherical_direction(0.6, 0.4);
  const double expected = mean(TableBsdf(table(), at).albedo(wo));
  EXPECT_NEAR(textured().at(at).albedo(wo), expected, 0.2 * expected);
}

constexpr const char* kThickness = "film_thickness_nm = {from = 500, to = 1000, count = 2}\n";
constexpr const char* kBaseIor = "base_ior = {from = 1.3, to = 1.8, count = 4}\n";
constexpr const char* kAbsorption = "absorption_per_nm = {from = 0, to = 1, count = 8}\n";

std::string mirror() { return layer(57, 2.4) + layer(94, 1.46); }
std::string chitin() { return layer(90, 1.56, 0.01) + layer(70, 1.7, 0.06); }

std::string surface(const std::string& roughness, double absorption_per_nm, int periods,
                    const std::string& more = "") {
  return "roughness = " + roughness + "\nfilm_periods = " + std::to_string(periods) +
         "\nabsorption_per_nm = " + to_text(absorption_per_nm) +
         "\npigment_thickness_nm = 2\nalbedo = 0.7\n" + more;
}
const std::string kIor = "base_ior = 1.5\n";

std::vector<Case> cases() {
  const std::string product = "absorption_path = \"product\"\n";
  return {
      {"product", surface("0.1", 0.1, 2, kIor + product), chitin(), kThickness},
      {"product_absorption", surface("0.1", 0.1, 2, kIor + product), chitin(),
       std::string(kThickness) + kAbsorption},
      {"product_smooth", surface("0", 0.1, 2, kIor + product), chitin(), kThickness},
      {"one_point", surface("0.1", 0.1, 5, kIor), mirror(), ""},

      {"mirror_smooth", surface("0", 0.1, 5, kIor), mirror(), kThickness},
      {"mirror_rough", surface("0.1", 0.1, 5, kIor), mirror(), kThickness},
      {"mirror_very_rough", surface("0.3", 0.1, 5, kIor), mirror(), kThickness},
      {"mirror_rgb3", surface("0.2", 0.1, 5, kIor), mirror(), kThickness, "rgb3"},
      {"mirror_straight", surface("0", 0.1, 5, "transmission = \"straight\"\n" + kIor), mirror(), kThickness},
      {"mirror_anisotropic", surface("[0.1, 0.3]", 0.1, 5, kIor), mirror(), kThickness, "full", 0.005, 20},
      {"mirror_base_ior", surface("0.1", 0.1, 5), mirror(), std::string(kThickness) + kBaseIor},
      {"absorbing", surface("0.1", 0.1, 4, kIor), chitin(), std::string(kThickness) + kAbsorption},
      {"absorbing_smooth", surface("0", 0.1, 4, kIor), chitin(), std::string(kThickness) + kAbsorption},
      {"all_parameters", surface("0", 0.1, 2), chitin(), std::string(kThickness) + kBaseIor + kAbsorption},
      {"spread", surface("0.1", 0.1, 2, kIor + "thickness_spread = 0.1\n"), chitin(), kThickness},
      {"metal", "roughness = 0.1\nbase_ior = 1.6\nbase_extinction = 2.9\n", layer(120, 2.4),
       "film_thickness_nm = {from = 20, to = 400, count = 2}\n"}};
}
// Where A is not within a channel: the truth is the live model without noise.
TEST(TexturedLayeredTable, AgreesWithTheExactModel) {
  for (const Case& one : cases()) {
    if (one.name != "mirror_smooth" && one.name != "metal") continue;
    VerifySettings settings;
    settings.points = 8;
    settings.truth = Estimator::exact;
    EXPECT_LT(verify(table_of(one), settings).textured_error.p99, 0.005) << one.name;
  }
}

// Films of a thousand layers and a tenth of a millimetre take hours.
TEST(TexturedLayeredTable, RefusesWhatTakesTooLong) {
  Table table = table_of(cases()[4]);
  table.factors.grid[0].nodes = {500, 1e5};
  table.factors.wavelengths.film_periods = 500;
  try {
    const TexturedTable textured(table);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("1000 layers up to 1e+05 nm take about"));
  }
}

INSTANTIATE_TEST_SUITE_P(, TexturedLayeredTables, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace sunbeam
