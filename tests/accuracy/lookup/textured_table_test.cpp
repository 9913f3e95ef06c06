// Textured parameters: the table bound to the same point is the reference, itself checked against live models
// elsewhere.
#include "sunbeam/textured_table.h"

#include <gmock/gmock.h>

#include "sunbeam/core/error.h"
#include "tests/accuracy/support.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/textured_errors.h"

namespace sunbeam {
namespace {

using test::mean_abs;
using test::random_parameters;
using test::SmallRecipe;
using test::sorted_errors;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const Vec3 kSteep = spherical_direction(0.3, 2.5);
const Vec3 kGrazing = spherical_direction(1.4, 5);
const Parameters kPoint{430, 1.37, 0.13};

constexpr const char* kGrid =
    "film_thickness_nm = {from = 0, to = 700, count = 5}\nbase_ior = {from = 1, to = 2, count = 8}\n"
    "absorption_per_nm = {from = 0, to = 1, count = 8}\n";
// Of dense tables, whose nodes are dear.
constexpr const char* kCoarseGrid =
    "film_thickness_nm = {from = 0, to = 700, count = 4}\nbase_ior = {from = 1, to = 2, count = 3}\n"
    "absorption_per_nm = {from = 0, to = 1, count = 3}\n";

struct Case {
  std::string name;
  SmallRecipe recipe;
  std::string encoding = "factored";
  std::string roughness = {};  // in place of the recipe's
  std::string table = {};      // more lines of [table]
  // Of the difference to bound tables, at random and at the corners of the grid.
  double median = 0.001, p99 = 0.01, corners = 0.01;
  int points = 100;  // random ones
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

void replace(std::string& text, const std::string& what, const std::string& by) {
  text.replace(text.find(what), what.size(), by);
}

// Bakes make no such tables any more, but files of earlier ones hold them. Any values do.
constexpr const char* kWithoutFrame = "dense_without_frame";
void remove_frame(Table& table) {
  table.frame = FrameKind::none;
  table.film_transmittance = NdArray();
  table.first_visit = NdArray();
}

Table baked(const Case& one) {
  std::string text = one.recipe.text();
  replace(text, "encoding = \"dense\"\n", "encoding = \"" + one.encoding + "\"\n" + one.table);
  if (!one.roughness.empty())
    replace(text, "roughness = " + to_text(one.recipe.roughness), "roughness = " + one.roughness);
  Table table = bake_table(parse_recipe(text, "small.toml"), {.seed = 1, .threads = 0, .on_progress = {}});
  if (one.name == kWithoutFrame) remove_frame(table);
  return table;
}

const Table& table_of(const Case& one) {
  static std::map<std::string, Table> cache;
  if (!cache.count(one.name)) cache[one.name] = baked(one);
  return cache.at(one.name);
}

class TexturedTables : public ::testing::TestWithParam<Case> {
 protected:
  const Table& table() const { return table_of(GetParam()); }
  const TexturedTable& textured() const {
    static std::map<std::string, TexturedTable> cache;
    return cache.try_emplace(GetParam().name, table()).first->second;
  }
};

// The second largest of a hundred moves between 0.006 and 0.02 with the points, where fringes stand free;
// these are always the same.
TEST_P(TexturedTables, AgreeWithBoundTables) {
  const TexturedTable& textured = this->textured();
  const std::vector<double> errors = sorted_errors(textured, table(), GetParam().points);
  const double median = errors[errors.size() / 2], p99 = errors[errors.size() - 2];
  EXPECT_LT(median, GetParam().median);
  EXPECT_LT(p99, GetParam().p99);
  RecordProperty("median", std::to_string(median));
  RecordProperty("p99", std::to_string(p99));
}

TEST_P(TexturedTables, AgreeAtTheCornersOfTheGrid) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    std::array<double, 3> x;
    for (std::size_t k = 0; k < 3; ++k) {
      const Axis& axis = table().parameter_axis(k);
      x[k] = corner >> k & 1 ? axis.high() : axis.low();
    }
    for (int k = 0; k < 4; ++k) {
      Rng draws(6, 1 + static_cast<std::uint64_t>(4 * corner + k));
      most = std::max(most, test::error_at(textured(), table(), {x[0], x[1], x[2]}, draws));
    }
  }
  EXPECT_LT(most, GetParam().corners);
  RecordProperty("most", std::to_string(most));
}

// No more than arrives is reflected, or than by a bound table, whose bake has noise. 4.5 standard errors of
// the quadrature: false alarm 25 x 36 x 4e-6 in all.
TEST_P(TexturedTables, NoMoreEnergyThanArrives) {
  for (const double thickness : {0.0, 480.0})
    for (const double ior : {1.0, 1.7}) {
      const Parameters at{thickness, ior, 0};
      const TexturedTable::At bsdf = textured().at(at);
      const TableBsdf reference(table(), at);
      for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
        const test::RgbMean found = test::albedo_by_eval(bsdf, wo, 64, 4, 4);
        const Rgb dirac = bsdf.dirac(wo), most = reference.albedo(wo);
        for (int c = 0; c < 3; ++c)
          EXPECT_LE(found[c].mean() + dirac[c], std::max(1.0, most[c]) + 1e-3 + 4.5 * found[c].std_error())
              << thickness << ' ' << ior << ' ' << wo.z;
      }
    }
}

// 25 tables x 3 directions, false alarm 1e-3 in all.
TEST_P(TexturedTables, SamplesFollowThePdf) {
  const TexturedTable& textured = this->textured();
  const auto bsdf = textured.at(kPoint);
  for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
    const auto result = test::chi_square_of_sampling(bsdf, wo, {.samples = 100000, .pdf_samples = 16}, 1);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 75)) << wo.z;
    EXPECT_GT(result.degrees, 100) << wo.z;
  }
}

// Int pdf + P(Dirac) + P(empty) = 1; 4.5 standard errors, false alarm 25 x 3 x 7e-6 in all.
TEST_P(TexturedTables, ProbabilitiesAddUpToOne) {
  const TexturedTable& textured = this->textured();
  const auto bsdf = textured.at(kPoint);
  for (const Vec3& wo : {kOblique, kSteep, kGrazing}) {
    const auto totals = test::sample_totals(bsdf, wo, 200000, 3);
    const auto integral =
        test::integrate_pdf(bsdf, wo, wo.z < 0.2 && GetParam().points == 100 ? 800 : 200, 4, 3);
    EXPECT_LT(
        test::deviation(totals.seen.mean(), totals.seen.std_error(), integral.mean(), integral.std_error()),
        4.5)
        << wo.z;
  }
}

TEST_P(TexturedTables, ThroughputIsValueOverDensity) {
  const TexturedTable& textured = this->textured();
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
TEST_P(TexturedTables, EvalAndSampleIsEvalPdfAndThenSample) {
  EXPECT_LT(test::difference_together(textured().at(kPoint), 200, 8), 1e-6);
}

// Of what a path is multiplied by, Dirac or not: relative variance, mean over channels. That of a density
// that is far from the light, or of a technique that is hardly ever chosen, is many times as large.
TEST_P(TexturedTables, SamplesAreEven) {
  const auto textured = this->textured().at(kPoint);
  const TableBsdf bound(table(), kPoint);
  // A bound table averages its density over the azimuths of an anisotropic one's viewers.
  const bool is_even = bound.is_isotropic() && GetParam().name != kWithoutFrame;
  for (const Vec3& wo : {kOblique, kSteep}) {
    const auto variance = [&](const Bsdf& bsdf) {
      const test::RunningMean albedo = test::sample_totals(bsdf, wo, 20000, 5).albedo.grey;
      return albedo.variance() / square(albedo.mean());
    };
    EXPECT_LT(variance(textured), 0.12) << wo.z;
    EXPECT_LT(variance(bound), is_even ? 0.008 : 0.1) << wo.z;
  }
}

TEST_P(TexturedTables, AlbedoEstimateIsNear) {
  const TexturedTable& textured = this->textured();
  for (const Vec3& wo : {kOblique, kSteep}) {
    const double expected = mean(TableBsdf(table(), kPoint).albedo(wo));
    EXPECT_NEAR(textured.at(kPoint).albedo(wo), expected, 0.2 * expected) << wo.z;
  }
}

TEST_P(TexturedTables, Reciprocal) {
  const TexturedTable& textured = this->textured();
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
  const TexturedTable& textured = this->textured();
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

// What a hit of a scene has room for (runtime/tracer/surface_bsdf.h), with a matrix of colours.
TEST(TexturedTable, HitsAreSmall) { EXPECT_LE(sizeof(TexturedTable::At), 400u); }

SmallRecipe recipe_of(double roughness, const std::string& transmission, const std::string& spectrum) {
  SmallRecipe recipe;
  recipe.roughness = roughness;
  recipe.transmission = transmission;
  recipe.spectrum = spectrum;
  recipe.grid = kGrid;
  return recipe;
}

SmallRecipe product_of(double roughness, const std::string& transmission, const std::string& spectrum) {
  SmallRecipe recipe = recipe_of(roughness, transmission, spectrum);
  recipe.path = "product";
  return recipe;
}

SmallRecipe dense_of(double roughness, const std::string& material, const std::string& spectrum,
                     const std::string& path = "sum") {
  SmallRecipe recipe = recipe_of(roughness, "refract", spectrum);
  recipe.material = material;
  recipe.path = path;
  recipe.grid = kCoarseGrid;
  recipe.noise = 0.1;
  return recipe;
}

constexpr const char* kPigment = "absorption_spectrum = \"eumelanin\"\n";

SmallRecipe with_albedo(SmallRecipe recipe, double albedo) {
  recipe.albedo = albedo;
  return recipe;
}
SmallRecipe with(SmallRecipe recipe, const std::string& material) {
  recipe.material = material;
  return recipe;
}

Case bounded(Case one, double median, double p99, double corners, int points) {
  one.median = median;
  one.p99 = p99;
  one.corners = corners;
  one.points = points;
  return one;
}

// Isotropic and of path "sum".
std::vector<Case> plain_cases() {
  const std::string full = "mode = \"full\"\n";
  const Case smooth{"smooth", recipe_of(0, "refract", full)},
      straight{"straight_smooth", recipe_of(0, "straight", full)};
  return {{"rough", recipe_of(0.1, "refract", full)},
          {"very_rough", recipe_of(0.5, "refract", full)},
          // Dark corners at grazing: 1.1 to 1.6 % of directions drawn by three seeds, whatever Q's nodes.
          bounded({"straight", recipe_of(0.1, "straight", full)}, 0.001, 0.01, 0.02, 100),
          {"white", with_albedo(recipe_of(0.2, "refract", ""), 1)},
          // Thin films over a base without contrast, at grazing.
          bounded({"rgb3", recipe_of(0.2, "refract", "")}, 0.001, 0.01, 0.01, 100),
          // Fringes of the thickest film, standing free, at grazing.
          bounded(smooth, 0.001, 0.01, 0.06, 100),
          bounded(straight, 0.001, 0.01, 0.06, 100),
          // The darkest corner, where 3e-4 of the light is left; errors are relative to 2e-3.
          bounded({"eumelanin", with(recipe_of(0.1, "refract", full), kPigment)}, 0.001, 0.01, 0.05, 50)};
}

std::vector<Case> product_cases() {
  const std::string full = "mode = \"full\"\n";
  const auto usual = [](const std::string& name, const SmallRecipe& recipe) {
    return bounded({name, recipe}, 0.002, 0.01, 0.01, 50);
  };
  return {usual("product", product_of(0.1, "refract", full)),
          usual("product_smooth", product_of(0, "refract", full)),
          bounded({"product_straight", product_of(0.1, "straight", full)}, 0.002, 0.01, 0.02, 50),
          usual("product_rgb3", product_of(0.2, "refract", "")),
          usual("product_white", with_albedo(product_of(0.2, "refract", ""), 1)),
          bounded({"product_eumelanin", with(product_of(0.1, "refract", full), kPigment)}, 0.002, 0.01, 0.05,
                  50)};
}

std::vector<Case> anisotropic_cases() {
  const std::string full = "mode = \"full\"\n", along = "[0.1, 0.3]";
  return {bounded({"anisotropic", recipe_of(0.1, "refract", full), "factored", along}, 0.002, 0.01, 0.01, 20),
          bounded({"anisotropic_product", product_of(0.1, "refract", ""), "factored", along}, 0.002, 0.01,
                  0.01, 20)};
}

// Single floats in place of doubles are all the difference.
std::vector<Case> dense_cases() {
  const std::string full = "mode = \"full\"\n", slab = "scattering_per_nm = 0.5\nanisotropy = 0.5\n";
  const auto exact = [](const std::string& name, const SmallRecipe& recipe, const std::string& roughness = "",
                        const std::string& table = "") {
    return bounded({name, recipe, "dense", roughness, table}, 1e-5, 1e-4, 2e-4, 20);
  };
  SmallRecipe facets = dense_of(0.4, "microfacet = \"multiple\"\n", "");
  facets.noise = 0.5;  // walks are dear
  facets.cosines = 5;
  return {exact("dense", dense_of(0.1, "", full)),
          exact("dense_smooth", dense_of(0, "", "")),
          exact("dense_product", dense_of(0.1, kPigment, full, "product")),
          exact("dense_white", with_albedo(dense_of(0.2, "", ""), 1)),
          exact("dense_anisotropic", dense_of(0.1, "", ""), "[0.1, 0.3]", "azimuths = 4\n"),
          exact(kWithoutFrame, dense_of(0.1, "", full)),
          exact("slab", dense_of(0.2, slab, full)),
          exact("slab_smooth", dense_of(0, slab, "")),
          exact("multiple_facets", facets, "", "azimuths = 2\n")};
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto& some : {plain_cases(), product_cases(), anisotropic_cases(), dense_cases()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}
INSTANTIATE_TEST_SUITE_P(, TexturedTables, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

// One node of every parameter.
TEST(TexturedTable, OnePoint) {
  for (const std::string encoding : {"factored", "dense"}) {
    const Table table = baked({"one", {}, encoding});
    const std::vector<double> errors = sorted_errors(TexturedTable(table), table, 21);
    EXPECT_LT(errors[errors.size() / 2], 0.001);
  }
}

}  // namespace
}  // namespace sunbeam
