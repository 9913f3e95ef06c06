// Factored tables whose base IORs cross the exterior's, against the exact evaluator: 32 random pairs of
// exterior and film, under every kind of isotropic surface. The rows of a pair follow one another.
//
// Each test prints its figures as a line of a table; --gtest_also_run_disabled_tests adds the rows that no
// suite has time for.
#include <gtest/gtest.h>

#include <cstdio>

#include "bake/check/verify.h"
#include "bake/jobs/bake.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/text.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_io.h"
#include "sunbeam/textured_table.h"

namespace sunbeam {
namespace {

constexpr int kPairs = 32, kSurfaces = 16;

double rounded(double x) { return std::round(1000 * x) / 1000; }

struct Row {
  explicit Row(int number) : number(number) {
    Rng rng(18, static_cast<std::uint64_t>(number / kSurfaces));
    exterior_ior = rounded(lerp(rng.uniform(), 1.05, 2));
    film_ior = rounded(lerp(rng.uniform(), 1.2, 2));
    albedo = rounded(lerp(rng.uniform(), 0.1, 0.9));
  }

  std::string roughness() const { return std::array{"0", "0.05", "0.1", "0.3"}[surface() / 4]; }
  std::string path() const { return surface() / 2 % 2 == 0 ? "sum" : "product"; }
  std::string transmission() const { return surface() % 2 == 0 ? "straight" : "refract"; }

  // Twice the nodes of the shipped recipe, but for the absorption.
  Recipe recipe() const {
    return parse_recipe("[material]\ntransmission = \"" + transmission() + "\"\nabsorption_path = \"" +
                            path() + "\"\nroughness = " + roughness() +
                            "\nexterior_ior = " + to_text(exterior_ior) +
                            "\nfilm_ior = " + to_text(film_ior) + "\nalbedo = " + to_text(albedo) + R"(
pigment_thickness_nm = 2
[grid]
film_thickness_nm = {from = 0.0, to = 1500.0, count = 4}
base_ior = {from = 1.0, to = 2.5, count = 20}
absorption_per_nm = {from = 0.0, to = 1.5, count = 12}
[table]
encoding = "factored"
angles = 24
[accuracy]
noise = 0.01
)",
                        "below");
  }

  int surface() const { return number % kSurfaces; }

  int number;
  double exterior_ior, film_ior, albedo;

  friend void PrintTo(const Row& row, std::ostream* out) { *out << row.number; }
};

// How much more of the light along wi the textured table returns than the bound one, in the worst channel.
double more_returned(const TexturedTable::At& textured, const TableBsdf& bound, const Vec3& wi) {
  constexpr int kCosines = 64;
  Rgb sum;
  for (int k = 0; k < kCosines; ++k) {
    const double cosine = (k + 0.5) / kCosines;
    const Vec3 wo = direction_from_cosine(cosine, kPi / 2);
    sum += 2 * kPi * cosine / kCosines * (textured.eval_pdf(wo, wi).f - bound.eval_pdf(wo, wi).f);
  }
  return max_component(sum);
}

double textured_energy(const Table& table, const std::vector<VerifyPoint>& points) {
  constexpr std::size_t kPoints = 50;
  const TexturedTable textured(table);
  double most = 0;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const VerifyPoint& point = points[k];
    const Vec3 wi = direction_from_cosine(point.cos_i, 0);
    const double more = more_returned(textured.at(point.parameters), table.bind(point.parameters), wi);
    most = std::max(most, point.albedo + more);
  }
  return most;
}

class BelowExterior : public ::testing::TestWithParam<Row> {};

// Truth and look-ups have no noise but the bake's own: no false alarm.
TEST_P(BelowExterior, HoldsTheExactEvaluator) {
  const Row& row = GetParam();
  const Table table = bake_table(row.recipe(), {.seed = 1, .threads = 0, .on_progress = {}});
  VerifySettings settings;
  settings.points = 250;
  settings.truth = Estimator::exact;
  const VerifyReport report = verify(table, settings);
  const double textured_most = textured_energy(table, report.points);
  std::printf("| %d | %.3f | %.3f | %s | %s | %s | %.4f | %.3f | %.4f | %.3f | %.5f | %.5f | %zu |\n",
              row.number, row.exterior_ior, row.film_ior, row.roughness().c_str(), row.path().c_str(),
              row.transmission().c_str(), 100 * report.error.median, 100 * report.error.p99,
              100 * report.textured_error.median, 100 * report.textured_error.p99, report.energy_max,
              textured_most, table_exr_bytes(table).size() / 1000);
  EXPECT_LE(report.error.median, 0.002);
  EXPECT_LE(report.error.p99, 0.02);
  EXPECT_LE(report.textured_error.median, 0.002);
  EXPECT_LE(report.textured_error.p99, 0.02);
  EXPECT_LE(report.energy_max, 1.001);
  EXPECT_LE(textured_most, 1.001);
}

// Every pair with another surface, and those `first` of every `step` alone.
std::vector<Row> rows(int first, int step) {
  std::vector<Row> result;
  for (int pair = first; pair < kPairs; pair += step)
    result.emplace_back(pair * kSurfaces + pair % kSurfaces);
  return result;
}

std::vector<Row> all_rows() {
  std::vector<Row> result;
  for (int number = 0; number < kPairs * kSurfaces; ++number) result.emplace_back(number);
  return result;
}

std::string name_of(const ::testing::TestParamInfo<Row>& info) { return std::to_string(info.param.number); }

INSTANTIATE_TEST_SUITE_P(Some, BelowExterior, ::testing::ValuesIn(rows(1, 9)), name_of);
INSTANTIATE_TEST_SUITE_P(Long, BelowExterior, ::testing::ValuesIn(rows(0, 1)), name_of);
INSTANTIATE_TEST_SUITE_P(DISABLED_All, BelowExterior, ::testing::ValuesIn(all_rows()), name_of);

}  // namespace
}  // namespace sunbeam
