// Bound and textured look-ups of factored tables against the exact evaluator, for coloured and bright bases
// in water, where the default skin has a dark grey one in air.
#include "bake/check/verify.h"
#include "tests/accuracy/factored/support.h"

namespace sunbeam {
namespace {

using test::FilmRow;

constexpr const char* kColoured = "[0.8, 0.4, 0.1]";
constexpr const char* kBright = "0.9";

// The largest median and p99 of both look-ups, within three times what is measured.
struct OtherMaterial {
  std::string albedo, spectrum;
  FilmRow film;
  double median, p99, textured_median, textured_p99;

  std::string name() const {
    return (albedo == kBright ? "bright_" : "coloured_") + film.name() + "_" + spectrum;
  }
  friend void PrintTo(const OtherMaterial& row, std::ostream* out) { *out << row.name(); }
};

const Table& table_of(const OtherMaterial& row) {
  return test::factored(
      row.film, row.spectrum,
      {"material.exterior_ior=1.33", "material.base_ior=1.5", "material.albedo=" + row.albedo,
       "grid.film_thickness_nm={from=0, to=500, count=5}", "grid.base_ior={from=1.4, to=1.7, count=4}",
       "grid.absorption_per_nm={from=0, to=0.7, count=8}", "accuracy.noise=0.001"});
}

std::vector<OtherMaterial> other_materials() {
  return {
      {kColoured, "full", {"0", "refract", "sum"}, 5e-5, 0.0015, 0.0003, 0.006},
      {kBright, "rgb3", {"0", "straight", "product"}, 0.0002, 0.002, 4e-5, 0.006},
      {kColoured, "rgb3", {"0", "refract", "product"}, 0.0001, 0.002, 0.0003, 0.004},
      {kColoured, "full", {"0.1", "refract", "sum"}, 0.0008, 0.0012, 0.001, 0.015},
      {kColoured, "rgb3", {"0.1", "straight", "sum"}, 0.0002, 0.0025, 0.0008, 0.015},
      {kBright, "rgb3", {"0.1", "refract", "product"}, 0.0008, 0.0025, 0.0012, 0.03},
      {kColoured, "rgb3", {"0.1", "straight", "product"}, 0.00025, 0.0025, 0.0008, 0.01},
      {kBright, "rgb3", {"0.3", "refract", "sum"}, 0.0008, 0.005, 0.005, 0.02},
      {kColoured, "rgb3", {"0.3", "refract", "product"}, 0.0008, 0.004, 0.005, 0.02},
      {kColoured, "rgb3", {"[0.1, 0.3]", "refract", "sum"}, 0.0008, 0.008, 0.0025, 0.015},
      {kBright, "rgb3", {"[0.1, 0.3]", "refract", "product"}, 0.002, 0.015, 0.004, 0.015},
  };
}

class OtherMaterials : public ::testing::TestWithParam<OtherMaterial> {};

// Neither side has noise but the bake's own: no false alarm, the same figures for every thread count.
TEST_P(OtherMaterials, AreBelowTheirBounds) {
  const OtherMaterial& row = GetParam();
  VerifySettings settings;
  settings.points = 32;
  settings.truth = Estimator::exact;
  const VerifyReport report = verify(table_of(row), settings);
  EXPECT_LT(report.error.median, row.median);
  EXPECT_LT(report.error.p99, row.p99);
  EXPECT_LT(report.textured_error.median, row.textured_median);
  EXPECT_LT(report.textured_error.p99, row.textured_p99);
  EXPECT_LT(report.dirac_error_p99, 1e-5);
  EXPECT_LE(report.energy_max, 1 + 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Each, OtherMaterials, ::testing::ValuesIn(other_materials()),
                         [](const auto& info) { return info.param.name(); });

}  // namespace
}  // namespace sunbeam
