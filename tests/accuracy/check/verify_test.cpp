// verify() reports the error that is there: of good tables, and of damaged ones whose error is known.
#include "bake/check/verify.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "bake/live/pfmc.h"
#include "sunbeam/core/error.h"
#include "sunbeam/table_io.h"
#include "tests/accuracy/support.h"
#include "tests/support/quadrature.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

VerifySettings settings(int points, double tolerance_median) {
  VerifySettings s;
  s.points = points;
  s.tolerance_median = tolerance_median;
  s.tolerance_p99 = 5 * tolerance_median;
  return s;
}

// A clear pigment under a smooth film: the remainder is one constant, kd/pi kd rho / (1 - kd rho), so that
// the table is exact but for its noise and the film's interpolation.
const Table& clear_table() {
  test::SmallRecipe recipe;
  recipe.roughness = 0;
  recipe.absorption_per_nm = 0;
  recipe.albedo = 0.9;
  recipe.base_ior = 1.5;
  recipe.noise = 0.0005;
  return test::baked(recipe);
}

// rho = 2 Int mu R_below(mu) dmu, mean over the channels' shares kd rho of the rest.
double later_visits_share(const Material& m) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    sum +=
        m.albedo[c] * 2 * test::integrate(0, 1, 64, [&](double mu) {
          return mu * airy(ThinFilm{m.exterior_ior, m.film_ior, m.base_ior, m.film_thickness_nm}.reversed(),
                           mu, {650, 510, 475})
                          .reflectance[c];
        });
  return sum / 3;
}

TEST(Verify, GoodTableIsWithinTolerance) {
  for (const double roughness : {0.0, 0.1}) {
    test::SmallRecipe recipe;
    recipe.roughness = roughness;
    recipe.cosines = 10;
    recipe.noise = 0.005;
    recipe.albedo = 0.3;
    recipe.grid = "film_thickness_nm = [340, 350, 360]";
    const auto s = settings(40, 0.03);
    const VerifyReport report = verify(test::baked(recipe), s);
    EXPECT_TRUE(within_tolerance(report, s))
        << roughness << ": " << report.error.median << ' ' << report.error.p99;
    EXPECT_LE(report.energy_max, 1);
    EXPECT_LT(report.reciprocity_max, 1e-6);  // look-ups in single floats
    EXPECT_EQ(report.truth, "pfmc-unidirectional");
    EXPECT_EQ(report.points.size(), 40u);
  }
}

// The table is as good as exact, so that its error is the live run's noise alone, while the floor is the
// difference of two such runs: 1 / sqrt(2) = 0.71 of it on average. A floor taken from the runs that ended
// the search for the number of walks would be too low, and the ratio was then 1.2. Within 25 % for 100
// points.
TEST(Verify, ExactTableIsAtTheNoiseFloor) {
  const VerifyReport report = verify(clear_table(), settings(100, 0.06));
  EXPECT_GT(report.noise_floor.median, 0.002);  // well above the table's own noise
  EXPECT_GT(report.error.median / report.noise_floor.median, 0.71 / 1.25);
  EXPECT_LT(report.error.median / report.noise_floor.median, 0.71 * 1.25);
}

// A third of the tolerance is what each point may expect; a point's own draw scatters about it, so the
// promise holds for the median and, three times over, for every point.
TEST(Verify, NoiseFloorFollowsTheTolerance) {
  const VerifyReport coarse = verify(clear_table(), settings(30, 0.06));
  const VerifyReport fine = verify(clear_table(), settings(30, 0.006));
  EXPECT_LE(coarse.noise_floor.median, 0.02);
  EXPECT_LE(fine.noise_floor.median, 0.002);
  EXPECT_LE(coarse.noise_floor.max, 0.06);
  EXPECT_LE(fine.noise_floor.max, 0.006);
  EXPECT_GT(coarse.noise_floor.median, 1.5 * fine.noise_floor.median);
}

// Where the least number of walks is not enough, 0.85 of the promise is aimed at. A point's own draw scatters
// by about half of it, so that the mean of 160 points is within 18 % at 4.5 standard errors: false alarm
// 7e-6.
TEST(Verify, NoiseFloorIsWhatIsAimedAt) {
  const VerifyReport report = verify(clear_table(), settings(160, 0.006));
  test::RunningMean floor;
  for (const VerifyPoint& point : report.points) floor.add(point.noise_floor / (0.85 * 0.006 / 3));
  EXPECT_GT(floor.mean(), 0.82);
  EXPECT_LT(floor.mean(), 1.18);
  EXPECT_LT(floor.std_error(), 0.045);
}

// Later visits are a share kd rho of the rest, the same for every pair of directions. With the remainder
// scaled by 1.5 the rest is off by 0.5 kd rho everywhere; noise, up to a few times the floor of 0.01 at
// single points, adds or subtracts at most itself.
TEST(Verify, ScaledRemainder) {
  Table damaged = clear_table();
  for (float& value : damaged.remainder.values()) value *= 1.5f;
  const double expected = 0.5 * later_visits_share(damaged.material);
  ASSERT_GT(expected, 0.06);
  const auto s = settings(40, 0.03);
  const VerifyReport good = verify(clear_table(), s), report = verify(damaged, s);
  for (const Quantiles& found : {report.error, report.textured_error, report.rest_error}) {
    EXPECT_NEAR(found.median, expected, 0.01);
    EXPECT_NEAR(found.max, expected, good.error.max + 0.02);
  }
  EXPECT_LT(good.error.max, expected);
  EXPECT_TRUE(within_tolerance(good, s));
  EXPECT_FALSE(within_tolerance(report, s));
  EXPECT_LT(report.dirac_error_p99, 5e-3);
}

// Both look-ups of a dense table interpolate the same arrays; those of a factored one are fits of their own,
// and the textured one is the coarser.
TEST(Verify, TexturedLookUpHasItsOwnError) {
  const VerifyReport dense = verify(clear_table(), settings(20, 0.06));
  EXPECT_NEAR(dense.textured_error.median, dense.error.median, 1e-4);
  const Table factored = load_table_exr(std::string(SUNBEAM_SOURCE_DIR) + "/tables/golden/preview.exr");
  VerifySettings by_exact = settings(20, 0.06);
  by_exact.truth = Estimator::exact;
  const VerifyReport report = verify(factored, by_exact);
  EXPECT_GT(report.textured_error.median, 1.2 * report.error.median);
  EXPECT_LT(report.textured_error.p99, 0.01);
}

// One channel alone is a third of the error.
TEST(Verify, ScaledChannel) {
  Table damaged = clear_table();
  auto values = damaged.remainder.values();
  for (std::size_t k = 0; k < values.size(); k += 3) values[k] *= 2.5f;
  const double expected = 1.5 * later_visits_share(damaged.material) / 3;
  EXPECT_NEAR(verify(damaged, settings(40, 0.03)).error.median, expected, 0.015);
}

// R shifted by 0.05 shows as just that in the Dirac, and in the rest as (T - 0.05)^2 / T^2 at normal
// incidence; seen over all directions at least 2 * 0.05 of a T below 1, minus the table's own error.
TEST(Verify, ShiftedFilmReflectance) {
  Table damaged = clear_table();
  for (float& value : damaged.film_reflectance.values()) value += 0.05f;
  const VerifyReport report = verify(damaged, settings(40, 0.03));
  EXPECT_NEAR(report.dirac_error_p99, 0.05, 0.005);  // 0.005: interpolation near grazing
  EXPECT_GT(report.error.median, 0.1 - 0.05 * 0.05 - 0.01);
  EXPECT_LT(report.error.median, 0.25);
}

// Stored values moved at random by 40 % leave the remainder off by 0.4 sqrt(2 / pi) = 32 % on average at the
// nodes; cubic interpolation in two directions averages some of them and overshoots beside the ends, so that
// between a third and 1.3 times of it is left, times the remainder's share. And the table is not symmetric
// any more.
TEST(Verify, NoisyTable) {
  Table damaged = clear_table();
  Rng rng(1, 0);
  for (std::size_t cell = 0; cell < damaged.remainder.cells(); ++cell) {
    const double normal = std::sqrt(-2 * std::log(1 - rng.uniform())) * std::cos(2 * kPi * rng.uniform());
    damaged.remainder.set(cell, (1 + 0.4 * normal) * damaged.remainder.get(cell));
  }
  const double whole = 0.4 * std::sqrt(2 / kPi) * later_visits_share(damaged.material);
  const VerifyReport report = verify(damaged, settings(40, 0.03));
  EXPECT_GT(report.error.median, whole / 3);
  EXPECT_LT(report.error.median, 1.3 * whole + 0.01);
  EXPECT_GT(report.reciprocity_max, 0.01);
}

TEST(Verify, SameSettingsSameFigures) {
  auto s = settings(20, 0.1);
  s.threads = 1;
  const auto one = figures(verify(clear_table(), s));
  s.threads = 2;
  EXPECT_EQ(figures(verify(clear_table(), s)), one);
  s.seed = 99;
  EXPECT_NE(figures(verify(clear_table(), s)), one);
}

// Points lie anywhere in the grid's box and within 89 degrees.
TEST(Verify, PointsCoverTheGrid) {
  test::SmallRecipe recipe;
  recipe.roughness = 0;
  recipe.noise = 0.03;
  recipe.grid = "film_thickness_nm = [300, 360]\nbase_ior = [1.4, 1.6]\nabsorption_per_nm = [0, 0.5]";
  const VerifyReport report = verify(test::baked(recipe), settings(200, 0.1));
  const auto spread = [&](double low, double high, auto value) {
    double least = 1e9, most = -1e9;
    for (const VerifyPoint& point : report.points) {
      least = std::min(least, value(point));
      most = std::max(most, value(point));
    }
    EXPECT_GE(least, low);
    EXPECT_LE(most, high);
    // 200 uniform draws leave an end tenth empty with probability 0.9^200 = 7e-10.
    EXPECT_LT(least, low + 0.1 * (high - low));
    EXPECT_GT(most, high - 0.1 * (high - low));
  };
  spread(300, 360, [](const VerifyPoint& p) { return p.parameters.film_thickness_nm; });
  spread(1.4, 1.6, [](const VerifyPoint& p) { return p.parameters.base_ior; });
  spread(0, 0.5, [](const VerifyPoint& p) { return p.parameters.absorption_per_nm; });
  spread(std::cos(89 * kPi / 180), 1, [](const VerifyPoint& p) { return p.cos_i; });
}

// Quantiles are order statistics of the points themselves.
TEST(Verify, QuantilesAreOfThePoints) {
  const VerifyReport report = verify(clear_table(), settings(40, 0.1));
  std::vector<double> errors;
  for (const VerifyPoint& point : report.points) errors.push_back(point.error);
  std::sort(errors.begin(), errors.end());
  EXPECT_EQ(report.error.median, errors[19]);  // 20 of 40 do not exceed it
  EXPECT_EQ(report.error.p95, errors[37]);     // 38 of 40
  EXPECT_EQ(report.error.p99, errors[39]);
  EXPECT_EQ(report.error.max, errors[39]);
}

// Nothing but walks knows multiple facets or peaked phase functions.
TEST(Verify, TheExactTruthNeedsAMaterialThatIsSolved) {
  Table table = clear_table();
  VerifySettings exact = settings(2, 0.1);
  exact.truth = Estimator::exact;
  EXPECT_NO_THROW(verify(table, exact));
  table.material.roughness = 0.1;
  table.material.microfacet = Microfacet::multiple;
  EXPECT_THAT([&] { verify(table, exact); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("key 'microfacet': found multiple")));
}

TEST(Verify, DefaultTruth) {
  const auto truth = [](const std::string& material, const std::string& accuracy = "") {
    return default_truth(parse_recipe(
        "[material]\n" + material + "\n[accuracy]\nestimator = \"bidirectional\"\n" + accuracy, "r"));
  };
  EXPECT_EQ(truth(""), Estimator::pfmc);
  EXPECT_EQ(truth("roughness = [0.1, 0.2]"), Estimator::pfmc);
  EXPECT_EQ(truth("roughness = [0.1, 0.2]", "tolerance_median = 0.002"), Estimator::exact);
  EXPECT_EQ(truth("roughness = 0.1\nmicrofacet = \"multiple\"", "tolerance_median = 0.002"), Estimator::pfmc);
  EXPECT_EQ(truth("scattering_per_nm = 1"), Estimator::bidirectional);
  EXPECT_EQ(truth("scattering_per_nm = 1", "tolerance_median = 0.002"), Estimator::exact);
}

VerifyReport report_of(double median, double p99, double max, double energy) {
  VerifyReport report;
  report.error = {median, p99, p99, max};
  report.energy = energy;
  return report;
}

// Tolerances of 0.01 and 0.05: the energy may be above 1 by three times error_max, but by 0.05 at most, and
// always by 0.001.
TEST(Verify, LimitsOfToleranceAndEnergy) {
  const VerifySettings s = settings(1, 0.01);
  const auto missed = [&](const VerifyReport& report) {
    EXPECT_EQ(within_tolerance(report, s), missed_limits(report, s).empty());
    EXPECT_EQ(within_tolerance(report, s), worst_share(report, s) <= 1);
    return missed_limits(report, s);
  };
  EXPECT_EQ(missed(report_of(0.01, 0.05, 9, 0.9)), "");
  EXPECT_EQ(missed(report_of(0.0101, 0.05, 9, 0.9)), "error_median 0.0101 (allowed 0.01)");
  EXPECT_EQ(missed(report_of(0.01, 0.0501, 9, 0.9)), "error_p99 0.0501 (allowed 0.05)");
  EXPECT_EQ(missed(report_of(0, 0, 9, 1.0499)), "");
  EXPECT_EQ(missed(report_of(0, 0, 9, 2.73)), "energy 2.73 (allowed 1.05)");
  EXPECT_EQ(missed(report_of(0, 0, 0.01, 1.0299)), "");
  EXPECT_EQ(missed(report_of(0, 0, 0.01, 1.0301)), "energy 1.03 (allowed 1.03)");
  EXPECT_EQ(missed(report_of(0, 0, 0, 1.0009)), "");
  EXPECT_EQ(missed(report_of(0, 0, 0, 1.0011)), "energy 1.001 (allowed 1.001)");
  EXPECT_EQ(missed(report_of(0.1, 0.2, 0.2, 1.2)),
            "error_median 0.1 (allowed 0.01), error_p99 0.2 (allowed 0.05), energy 1.2 (allowed 1.05)");
  EXPECT_NE(missed(report_of(0, 0, 0, NAN)), "");
  EXPECT_NE(missed(report_of(NAN, 0, 0, 0.5)), "");
}

// The better of two tables is the one whose worst figure is the smaller share of what is allowed.
TEST(Verify, WorstShareOrdersTables) {
  const VerifySettings s = settings(1, 0.01);
  EXPECT_NEAR(worst_share(report_of(0.02, 0.02, 0.02, 0.5), s), 2, 1e-12);
  EXPECT_NEAR(worst_share(report_of(0.005, 0.15, 0.2, 0.5), s), 3, 1e-12);
  EXPECT_NEAR(worst_share(report_of(0.005, 0.01, 0.2, 2.1), s), 2, 1e-12);
  EXPECT_EQ(worst_share(report_of(0.005, NAN, 0.2, 0.5), s), std::numeric_limits<double>::infinity());
}

// A white base under no film and a clear pigment sends everything back. The channels of a fold then hold 1,
// and so does the energy; scaled up, both grow with the table. A table in Rec.709 may hold more than 1 in a
// channel.
TEST(Verify, EnergyIsTheShareThatReturns) {
  for (const char* spectrum :
       {"mode = \"rgb3\"", "mode = \"full\"", "mode = \"full\"\ncolor_space = \"rec709\""}) {
    test::SmallRecipe recipe;
    recipe.roughness = 0;
    recipe.absorption_per_nm = 0;
    recipe.albedo = 1;
    recipe.noise = 0.002;
    recipe.spectrum = spectrum;
    Table table = test::baked(recipe);
    EXPECT_NEAR(verify(table, settings(10, 0.1)).energy, 1, 0.01) << spectrum;
    for (float& value : table.remainder.values()) value *= 1.5f;
    const VerifyReport bright = verify(table, settings(10, 0.1));
    EXPECT_GT(bright.energy, 1.05) << spectrum;
    EXPECT_LE(bright.energy, bright.energy_max * (1 + 1e-9)) << spectrum;
  }
}

TEST(Verify, FigureNames) {
  std::vector<std::string> names;
  for (const auto& [name, value] : figures(verify(clear_table(), settings(2, 0.1)))) {
    names.push_back(name);
    EXPECT_TRUE(std::isfinite(value)) << name;
  }
  EXPECT_THAT(names, ::testing::ElementsAre("error_median", "error_p95", "error_p99", "error_max",
                                            "error_textured_median", "error_textured_p95",
                                            "error_textured_p99", "error_textured_max", "rest_error_median",
                                            "rest_error_p99", "noise_floor", "noise_floor_p99",
                                            "dirac_error_p99", "energy_max", "reciprocity_max", "points"));
}

// A table file keeps the text of its recipe; what a recipe may no longer say does not make it unreadable.
TEST(Verify, PassesOverKeysThatRecipesHadOnce) {
  Table table = test::baked(test::SmallRecipe());
  VerifySettings settings;
  settings.points = 3;
  const VerifyReport before = verify(table, settings);
  std::string& recipe = table.info.at("recipe");
  const double noise = parse_recipe(recipe, "new.toml").accuracy.noise;
  const std::string accuracy = "[accuracy]\n";
  recipe.insert(recipe.find(accuracy) + accuracy.size(), "interpolation = 0.01\n");
  const std::string section = "[table]\n";
  recipe.insert(recipe.find(section) + section.size(), "frame = \"closed\"\n");
  recipe += "\n\n[limits]\nmegabytes = 64\n";
  const Table read = parse_table_exr(table_exr_bytes(table), "old.exr");
  EXPECT_EQ(read.info.at("recipe"), recipe);
  EXPECT_EQ(verify(read, settings).error.max, before.error.max);
  EXPECT_THROW(parse_recipe(recipe, "new.toml"), Error);
  EXPECT_EQ(parse_stored_recipe(recipe, "old.exr").accuracy.noise, noise);
}

// The shipped small table states its own error: measured again, by the same code and seed, it is the same;
// but for a rare direction drawn otherwise where instruction sets round the film's reflectance differently.
TEST(Golden, PreviewStatesItsError) {
  const std::string path = std::string(SUNBEAM_SOURCE_DIR) + "/tables/golden/preview.exr";
  ASSERT_TRUE(std::filesystem::exists(path))
      << path << " is missing: bake it from tables/recipes/preview.toml";
  const Table table = load_table_exr(path);
  const Recipe recipe = parse_stored_recipe(table.info.at("recipe"), path);
  VerifySettings s = verify_settings_of(recipe);
  s.points = 250;
  const VerifyReport report = verify(table, s);
  for (const auto& [name, value] : figures(report)) {
    ASSERT_TRUE(table.info.count("error." + name)) << name;
    double stated = 0;
    ASSERT_TRUE(parse_number(table.info.at("error." + name), stated)) << name;
    EXPECT_NEAR(value, stated, 2e-6 + 0.01 * std::abs(stated)) << name;
  }
  EXPECT_EQ(table.info.at("error.truth"), report.truth);
  EXPECT_TRUE(within_tolerance(report, s)) << report.error.median << ' ' << report.error.p99;
}

// And it is the table of the shipped recipe.
TEST(Golden, PreviewIsOfItsRecipe) {
  const std::string tables = std::string(SUNBEAM_SOURCE_DIR) + "/tables/";
  ASSERT_TRUE(std::filesystem::exists(tables + "golden/preview.exr"));
  const Table table = load_table_exr(tables + "golden/preview.exr");
  EXPECT_EQ(table.info.at("recipe_hash"), load_recipe(tables + "recipes/preview.toml").hash);
  EXPECT_EQ(table.info.at("recipe"), load_recipe(tables + "recipes/preview.toml").text);
}

}  // namespace
}  // namespace sunbeam
