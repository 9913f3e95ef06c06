// Factored tables of layered films drawn at random, both look-ups against the exact evaluator. Neither side
// has noise but that of a bake with path "product": no false alarm, the same figures for every thread count.
//
// Each test prints its figures in percent, a line a table, a line a kind of film and one of all.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <numeric>

#include "bake/check/verify.h"
#include "bake/jobs/bake.h"
#include "tests/support/random_layered_recipes.h"

namespace sunbeam {
namespace {

constexpr double kMostBytes = 16e6, kMostError = 0.005;
constexpr double kMostAlbedo = 1.001;  // of passive surfaces; albedos are tabulated to 0.001
constexpr double kMostAsymmetry = 1e-5;
constexpr int kPointsOfATable = 8;

double share_of(const std::vector<VerifyPoint>& points, double VerifyPoint::*error, double q) {
  std::vector<double> errors;
  for (const VerifyPoint& point : points) errors.push_back(point.*error);
  return quantile(errors, q);
}

void print_figures(const std::string& what, const std::vector<VerifyPoint>& points) {
  std::printf("| %s |", what.c_str());
  for (const auto error : {&VerifyPoint::error, &VerifyPoint::textured_error})
    std::printf(" %.4f | %.4f |", 100 * share_of(points, error, 0.5), 100 * share_of(points, error, 1));
  std::printf("\n");
}

test::LayeredRecipe drawn(int number) {
  Rng rng(21, static_cast<std::uint64_t>(number));
  return test::RandomLayeredRecipes(rng).draw(number);
}

// Bakes a recipe and draws points of its grid.
std::vector<VerifyPoint> points_of(int number, const Recipe& recipe) {
  const Table table = bake_table(recipe, {.seed = 1, .threads = 0, .on_progress = {}});
  EXPECT_TRUE(table.has_layered_film());
  EXPECT_LE(bytes_of(recipe, Encoding::factored), kMostBytes);
  VerifySettings settings;
  settings.points = kPointsOfATable;
  settings.seed = static_cast<std::uint64_t>(number);
  settings.truth = Estimator::exact;
  const VerifyReport report = verify(table, settings);
  EXPECT_LE(report.energy, kMostAlbedo);
  EXPECT_LE(report.reciprocity_max, kMostAsymmetry);
  return report.points;
}

void expect_small_errors(const std::vector<int>& numbers) {
  std::vector<VerifyPoint> all;
  std::map<std::string, std::vector<VerifyPoint>> of_kind;
  for (const int number : numbers) {
    const test::LayeredRecipe one = drawn(number);
    SCOPED_TRACE(std::to_string(number) + ":\n" + one.text);
    const auto points = points_of(number, parse_recipe(one.text, "drawn.toml"));
    print_figures(std::to_string(number), points);
    all.insert(all.end(), points.begin(), points.end());
    auto& kind = of_kind[name_of(one.kind)];
    kind.insert(kind.end(), points.begin(), points.end());
  }
  for (const auto& [kind, points] : of_kind) print_figures(kind, points);
  print_figures("all", all);
  for (const auto error : {&VerifyPoint::error, &VerifyPoint::textured_error, &VerifyPoint::dirac_error})
    EXPECT_LE(share_of(all, error, 0.99), kMostError);
}

// Clear, absorbing, dispersive and of uneven thickness.
TEST(LayeredTableSweep, HoldsTheExactEvaluator) { expect_small_errors({0, 1, 3, 4}); }

TEST(LongLayeredTables, HoldTheExactEvaluator) {
  std::vector<int> numbers(40);
  std::iota(numbers.begin(), numbers.end(), 0);
  expect_small_errors(numbers);
}

}  // namespace
}  // namespace sunbeam
