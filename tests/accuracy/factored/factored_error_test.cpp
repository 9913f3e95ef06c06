// Factored tables against the exact evaluator over all three parameters of the shipped recipe, and their
// size.
#include "bake/check/verify.h"
#include "sunbeam/table_io.h"
#include "tests/accuracy/factored/support.h"

namespace sunbeam {
namespace {

using test::FactoredTable;

// Neither side has noise but the bake's own: no false alarm, the same figures for every thread count.
void expect_below_bounds(const Table& table, const test::FilmRow& row, int points) {
  VerifySettings settings;
  settings.points = points;
  settings.truth = Estimator::exact;
  const bool is_plain = row.is_plain(), is_sum = row.path == "sum";
  const VerifyReport report = verify(table, settings);
  EXPECT_LT(report.error.median, !is_plain ? 2e-3 : is_sum ? 3e-4 : 5e-4);
  EXPECT_LT(report.error.p99, is_plain ? 5e-3 : 1e-2);
  EXPECT_LT(report.dirac_error_p99, 1e-5);
  EXPECT_LT(report.reciprocity_max, 1e-5);
  EXPECT_LE(report.energy_max, 1);
}

void expect_size(std::size_t bytes, const test::FilmRow& row) {
  EXPECT_LE(bytes, !row.is_plain() ? 16u << 20 : row.path == "sum" ? 512u << 10 : 2u << 20);
}

// Quadrature through rough films takes up to a third of a second a point at all wavelengths.
TEST_P(FactoredTable, IsBelowTheBoundsOfItsRow) {
  expect_below_bounds(table(), GetParam(), GetParam().is_smooth() ? 60 : 10);
}

TEST_P(FactoredTable, FitsItsSize) { expect_size(2 * table_exr_bytes(table()).size(), GetParam()); }

// The whole grid at three wavelengths.
class WholeFactoredTable : public ::testing::TestWithParam<test::FilmRow> {
 protected:
  static const Table& table() { return test::factored(GetParam(), "rgb3"); }
};

TEST_P(WholeFactoredTable, IsBelowTheBoundsOfItsRow) { expect_below_bounds(table(), GetParam(), 60); }

TEST_P(WholeFactoredTable, FitsItsSize) { expect_size(table_exr_bytes(table()).size(), GetParam()); }

INSTANTIATE_TEST_SUITE_P(Each, WholeFactoredTable, ::testing::ValuesIn(test::plain_rows()),
                         test::name_of_row);

}  // namespace
}  // namespace sunbeam
