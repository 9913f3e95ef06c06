// Factored tables against the exact evaluator over all three parameters of the shipped recipe, and their
// size.
#include "bake/verify.h"
#include "sunbeam/table_io.h"
#include "tests/accuracy/factored_support.h"

namespace sunbeam {
namespace {

class FactoredError : public ::testing::TestWithParam<test::SpectralRow> {
 protected:
  bool is_plain() const { return GetParam().row.is_plain(); }
  bool is_sum() const { return GetParam().row.path == "sum"; }
  bool is_whole() const { return GetParam().spectrum == "rgb3"; }
  const Table& table() const {
    const auto& [row, spectrum] = GetParam();
    return is_whole() ? test::factored(row, spectrum) : test::lower_half(row, spectrum);
  }
  // Quadrature through rough films takes up to a third of a second a point at all wavelengths.
  int points() const { return GetParam().row.is_smooth() || is_whole() ? 60 : 10; }
};

// Neither side has noise but the bake's own: no false alarm, the same figures for every thread count.
TEST_P(FactoredError, IsBelowTheBoundsOfItsRow) {
  VerifySettings settings;
  settings.points = points();
  settings.truth = Estimator::exact;
  const VerifyReport report = verify(table(), settings);
  EXPECT_LT(report.error.median, !is_plain() ? 2e-3 : is_sum() ? 3e-4 : 5e-4);
  EXPECT_LT(report.error.p99, is_plain() ? 5e-3 : 1e-2);
  EXPECT_LT(report.dirac_error_p99, 1e-5);
  EXPECT_LT(report.reciprocity_max, 1e-5);
  EXPECT_LE(report.energy_max, 1);
}

TEST_P(FactoredError, FitsItsSize) {
  const std::size_t bytes = (is_whole() ? 1 : 2) * table_exr_bytes(table()).size();
  EXPECT_LE(bytes, !is_plain() ? 16u << 20 : is_sum() ? 512u << 10 : 2u << 20);
}

INSTANTIATE_TEST_SUITE_P(Each, FactoredError, ::testing::ValuesIn(test::in_both_spectra(test::plain_rows())),
                         test::name_of_row);
INSTANTIATE_TEST_SUITE_P(Anisotropic, FactoredError,
                         ::testing::Values(test::SpectralRow{{"[0.1, 0.3]", "refract", "sum"}, "full"},
                                           test::SpectralRow{{"[0.1, 0.3]", "refract", "product"}, "full"}),
                         test::name_of_row);

}  // namespace
}  // namespace sunbeam
