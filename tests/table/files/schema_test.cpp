// Tables of schema version 2 look up as they did; tests/data of their values are those of the program that
// wrote them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sunbeam/core/error.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_io.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Value {
  double base_ior, theta_i, phi, theta_o;  // degrees; wi at azimuth phi from wo
  Rgb f;
};

void expect_values(const std::string& name, double tolerance, std::initializer_list<Value> values) {
  const Table table = load_table_exr(std::string(SUNBEAM_SOURCE_DIR) + "/tables/golden/" + name);
  EXPECT_EQ(table.schema_version, 2);
  for (const Value& value : values) {
    Parameters at = Parameters::of(table.material);
    at.base_ior = value.base_ior;
    const auto direction = [](double theta, double phi) {
      return direction_from_cosine(std::cos(theta * kPi / 180), phi * kPi / 180);
    };
    Rng rng(1, 0);
    const Rgb f = table.bind(at).eval(direction(value.theta_o, 0), direction(value.theta_i, value.phi), rng);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(f[c], value.f[c], tolerance * value.f[c]) << name << ' ' << value.base_ior;
  }
}

// Q of that program had 65 roots where that of bound look-ups has 33 now.
TEST(Schema2, FactoredTableHasItsValues) {
  expect_values("schema2_factored.exr", 2e-5,
                {{1.5, 10, 180, 30,
                  Rgb(0.0028603272512555122, 0.0028603272512555122, 0.0028603272512555122) +
                      Rgb(0.12705941498279572, 0.063051149249076843, 0.015673648566007614)},
                 {1.55, 40, 90, 60,
                  Rgb(0.00010578136425465345, 0.00020291753753554076, 0.00025856599677354097) +
                      Rgb(0.084518104791641235, 0.042135182768106461, 0.010487412102520466)},
                 {1.7, 75, 10, 20,
                  Rgb(5.1006572903133929e-06, 0.00049322680570185184, 0.00057342177024111152) +
                      Rgb(0.063986599445343018, 0.030917972326278687, 0.0077401464805006981)}});
}

TEST(Schema2, DenseTableHasItsValues) {
  expect_values("schema2_dense.exr", 1e-6,
                {{1.5, 10, 180, 30,
                  Rgb(0.0028603994287550449, 0.0028603994287550449, 0.0028603994287550449) +
                      Rgb(0.12711806499730438, 0.063064247255928005, 0.015673828957373754)},
                 {1.55, 40, 90, 60,
                  Rgb(0.00010340754670323804, 0.00020110435434617102, 0.00025710996123962104) +
                      Rgb(0.084732564843042604, 0.042225616376191266, 0.010500616310083597)},
                 {1.7, 75, 10, 20,
                  Rgb(5.1032088776992168e-06, 0.00049322564154863358, 0.00057341798674315214) +
                      Rgb(0.06441033219879444, 0.030929003721892969, 0.0077279971939482415)}});
}

std::string refusal_of(Table table) {
  try {
    parse_table_exr(table_exr_bytes(table), "table.exr");
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

// One dense table holds one critical angle.
TEST(Schema3, RefusesADenseTableOfSeveralBasesBelowTheExterior) {
  Table table = test::small_table();
  table.material.exterior_ior = 1.45;
  EXPECT_THAT(refusal_of(table), AllOf(HasSubstr("base_ior"), HasSubstr("1.4"), HasSubstr("1.45"),
                                       HasSubstr("one base_ior"), HasSubstr("found 2")));
}

// Over the cosine itself a factored table that reaches below would be read wrong.
TEST(Schema3, RefusesUnwarpedArraysBelowTheExterior) {
  Table table = test::small_factored_table({0.2, 0.2}, AbsorptionPath::sum);
  table.material.exterior_ior = 1.45;
  EXPECT_THAT(refusal_of(table), AllOf(HasSubstr("'cos_theta'"), HasSubstr("'warped_cos'")));
}

}  // namespace
}  // namespace sunbeam
