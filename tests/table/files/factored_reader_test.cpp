// Readers refuse a factored table that is not sound, naming the file and the defect, and survive damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/table/factored_tables.h"
#include "tests/table/files/factor_defects.h"

namespace sunbeam {
namespace {

using test::expect_named;
using test::Form;
using test::forms;
using test::in_colours;
using test::kName;
using test::refusal;
using test::small_factored_table;
using test::under_another_name;
using test::with_grid;
using test::with_name;
using test::with_nodes;
using test::with_wavelengths;
using test::without_last_axis;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(FactoredReader, NamesDefectsOfTheArrays) {
  expect_named(
      small_factored_table(),
      {{"no arrival", under_another_name(&Factors::arrival), {"'arrival' is missing", "returned, stray"}},
       {"no returned", under_another_name(&Factors::returned), {"'returned' is missing", "arrival, stray"}},
       {"renamed axis", with_name(&Factors::arrival, 2, "phase"), {"'arrival'", "'phase'", "'fringe_order'"}},
       {"renamed axis of returned",
        with_name(&Factors::returned, 1, "depth"),
        {"'returned'", "axis 1", "'depth'", "'optical_depth'"}},
       {"an axis too few", without_last_axis(&Factors::arrival), {"'arrival' has 4 axes", "expected 5"}},
       {"too few of returned",
        without_last_axis(&Factors::returned),
        {"'returned' has 2 axes", "expected 3"}},
       {"colours", in_colours(&Factors::arrival), {"'arrival' holds colours", "expected numbers"}},
       {"colours in returned",
        in_colours(&Factors::returned),
        {"'returned' holds colours", "expected numbers"}},
       {"more comes back than left",
        [](Table& t) { t.factors.returned.set(3, Rgb(1.5)); },
        {"'returned'", "0 to 1"}},
       {"less than nothing comes back",
        [](Table& t) { t.factors.returned.set(3, Rgb(-0.01)); },
        {"'returned'", "0 to 1"}},
       {"base IOR below 1", with_nodes(&Factors::arrival, 0, {0.9, 1.5}), {"'base_ior'", "1 to 5"}},
       {"base IOR of returned", with_nodes(&Factors::returned, 0, {1.4, 7}), {"'base_ior'", "1 to 5"}},
       {"depth below 0", with_nodes(&Factors::arrival, 1, {-1, 1}), {"'optical_depth'", "0 to"}},
       {"depth of returned", with_nodes(&Factors::returned, 1, {-1, 1}), {"'optical_depth'", "0 to"}},
       {"horizon", with_nodes(&Factors::arrival, 3, {0, 1}), {"'cos_theta'", "to 1"}},
       {"cosine above 1", with_nodes(&Factors::arrival, 3, {0.5, 1.01}), {"'cos_theta'", "to 1"}},
       {"azimuth of an isotropic film",
        with_nodes(&Factors::arrival, 4, {0, 1}),
        {"'phi' has 2", "isotropic"}}});
}

TEST(FactoredReader, NamesDefectsOfExchange) {
  expect_named(
      small_factored_table(0.3, AbsorptionPath::product),
      {{"no exchange", under_another_name(&Factors::exchange), {"'exchange' is missing", "arrival, stray"}},
       {"renamed axis", with_name(&Factors::exchange, 2, "kd"), {"'exchange'", "'kd'", "'albedo'"}},
       {"an axis too few", without_last_axis(&Factors::exchange), {"'exchange' has 7 axes", "expected 8"}},
       {"colours", in_colours(&Factors::exchange), {"'exchange' holds colours", "expected numbers"}},
       {"horizon", with_nodes(&Factors::exchange, 6, {0, 1}), {"'cos_theta_o'", "to 1"}},
       {"azimuth of an isotropic film", with_nodes(&Factors::exchange, 5, {0, 1}), {"'phi_i' has 2"}},
       {"wi and wo at other cosines",
        with_nodes(&Factors::exchange, 6, {0.5, 1}),
        {"'exchange'", "'cos_theta_i'", "'cos_theta_o'"}}});
}

TEST(FactoredReader, NamesDefectsOfAnAnisotropicTable) {
  const Table table = small_factored_table({0.3, 0.1}, AbsorptionPath::product);
  expect_named(
      table, {{"one azimuth", with_nodes(&Factors::arrival, 4, {0}), {"'phi' runs from 0 to 0", "1.57"}},
              {"beyond the quadrant", with_nodes(&Factors::exchange, 7, {0, kPi}), {"'phi_o' runs", "3.14"}},
              {"isotropic film", [](Table& t) { t.material.roughness = 0.1; }, {"symmetry is anisotropic"}}});
}

TEST(FactoredReader, NamesDefectsOfTheGrid) {
  expect_named(small_factored_table(),
               {{"an axis too few", [](Table& t) { t.factors.grid.pop_back(); }, {"'grid.*'", "3 axes"}},
                {"another parameter", with_grid(1, [](Axis& a) { a.name = "n2"; }), {"'n2'", "'base_ior'"}},
                {"thickness below 0",
                 with_grid(0,
                           [](Axis& a) {
                             a.nodes = {-1, 2};
                           }),
                 {"'film_thickness_nm'", "0 to"}},
                {"base IOR above 5",
                 with_grid(1,
                           [](Axis& a) {
                             a.nodes = {1, 6};
                           }),
                 {"'base_ior'", "1 to 5"}},
                {"absorption too large",
                 with_grid(2,
                           [](Axis& a) {
                             a.nodes = {0, 1e9};
                           }),
                 {"'absorption_per_nm'"}},
                {"falling nodes",
                 with_grid(0,
                           [](Axis& a) {
                             a.nodes = {2, 1};
                           }),
                 {"do not increase"}}});
}

TEST(FactoredReader, NamesDefectsOfTheWavelengths) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  expect_named(
      small_factored_table(),
      {{"an albedo too few", with_wavelengths([](Wavelengths& w) { w.albedo.pop_back(); }), {"'spectral.*'"}},
       {"a weight too many",
        with_wavelengths([](Wavelengths& w) { w.weight.push_back({}); }),
        {"'spectral.*'"}},
       {"none", with_wavelengths([](Wavelengths& w) { w = {}; }), {"'spectral.nm'"}},
       {"too many",
        with_wavelengths([](Wavelengths& w) {
          w = {std::vector(65, 500.0), std::vector(65, 0.5), std::vector(65, 1.0),
               std::vector(65, Rgb(0.01))};
        }),
        {"more than 64"}},
       {"a wavelength of nothing",
        with_wavelengths([](Wavelengths& w) { w.nm[2] = 0; }),
        {"'spectral.nm'", "holds 0;", "300 to 1000"}},
       {"an albedo above 1",
        with_wavelengths([](Wavelengths& w) { w.albedo[1] = 1.5; }),
        {"'spectral.albedo'"}},
       {"a pigment that shines",
        with_wavelengths([](Wavelengths& w) { w.absorption[0] = -1; }),
        {"'spectral.absorption'", "negative"}},
       {"no number",
        with_wavelengths([=](Wavelengths& w) { w.weight[0].g = kNan; }),
        {"'spectral.weight_g'"}}});
}

TEST(FactoredReader, NamesTheEncoding) {
  expect_named(
      small_factored_table(),
      {{"unknown", [](Table& t) { t.info["encoding"] = "sparse"; }, {"'sparse'", "dense, factored"}},
       {"the other one", [](Table& t) { t.info["encoding"] = "dense"; }, {"'rest_frame' is missing"}},
       {"none", [](Table& t) { t.info.erase("encoding"); }, {"'encoding' is missing"}}});
}

// The writer's own check comes first: a NaN in a file would change its hash as well.
TEST(FactoredWriter, ValuesThatAreNotFiniteAreRefused) {
  for (const Form& form : forms())
    for (const auto array : {&Factors::arrival, &Factors::returned}) {
      Table table = small_factored_table();
      (table.factors.*array).values()[5] = std::numeric_limits<float>::infinity();
      EXPECT_THAT([&] { form.bytes(table); },
                  ::testing::ThrowsMessage<Error>(
                      ::testing::AllOf(HasSubstr((table.factors.*array).name()), HasSubstr("not finite"))));
    }
}

TEST(FactoredReader, SurvivesFlippedBits) {
  const Table tables[] = {small_factored_table(), small_factored_table({0.3, 0.1}, AbsorptionPath::product)};
  for (std::size_t k = 0; k < std::size(tables); ++k) test::expect_survives_flipped_bits(tables[k], k);
}

TEST(FactoredReader, SurvivesTruncation) { test::expect_survives_truncation(small_factored_table()); }

}  // namespace
}  // namespace sunbeam
