// Readers refuse the table of a layered film that is not sound, naming the file and the defect, and survive
// damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/table/files/factor_defects.h"
#include "tests/table/layered_tables.h"

namespace sunbeam {
namespace {

using test::Defect;
using test::expect_named;
using test::Form;
using test::forms;
using test::in_colours;
using test::kName;
using test::layered_table;
using test::material_of;
using test::refusal;
using test::under_another_name;
using test::with_axis;
using test::with_grid;
using test::with_name;
using test::with_nodes;
using test::with_wavelengths;
using test::without_last_axis;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using Change = std::function<void(Table&)>;

Table layered_product() {
  return layered_table(material_of(0.3, AbsorptionPath::product), test::layered_waves());
}

Change with_value(NdArray Factors::*array, double value) {
  return [=](Table& table) { (table.factors.*array).values().back() = static_cast<float>(value); };
}

// An attribute of the file, in place of the one that the table would write.
Change with_attribute(const std::string& key, const std::string& text) {
  return [=](Table& table) { table.info[key] = text; };
}

Change with_layer(std::size_t layer, const std::function<void(FilmLayer&)>& change) {
  return with_wavelengths([=](Wavelengths& waves) {
    for (auto& layers : waves.layers) change(layers[layer]);
  });
}

TEST(LayeredReader, NamesDefectsOfFacets) {
  expect_named(
      layered_table(),
      {{"no cosines", under_another_name(&Factors::facet_cosine), {"'facet_cosine' is missing"}},
       {"no crossing", under_another_name(&Factors::crossing), {"'crossing' is missing"}},
       {"renamed axis", with_name(&Factors::facet_cosine, 0, "cos_theta"), {"'cos_theta'", "'theta'"}},
       {"renamed axis of crossing", with_name(&Factors::crossing, 4, "v"), {"'v'", "'facet_rank'"}},
       {"an axis too few", without_last_axis(&Factors::facet_cosine), {"'facet_cosine' has 2", "expected 3"}},
       {"too few of crossing", without_last_axis(&Factors::crossing), {"'crossing' has 4", "expected 5"}},
       {"colours", in_colours(&Factors::crossing), {"'crossing' holds colours", "expected numbers"}},
       {"beyond the horizon", with_nodes(&Factors::facet_cosine, 0, {0, 1.6}), {"'theta' leaves 0 to 1.57"}},
       {"an angle below 0", with_nodes(&Factors::facet_cosine, 0, {-0.1, 1}), {"'theta' leaves 0 to 1.57"}},
       {"azimuth of an isotropic film", with_nodes(&Factors::facet_cosine, 1, {0, 1}), {"'phi' has 2"}},
       {"ranks from 0.1",
        with_nodes(&Factors::facet_cosine, 2, {0.1, 1}),
        {"'facet_rank' runs from 0.1 to 1", "expected 0 to 1"}},
       {"one rank", with_nodes(&Factors::facet_cosine, 2, {1}), {"'facet_rank' runs from 1 to 1"}},
       {"other angles", with_nodes(&Factors::crossing, 2, {0, 1}), {"'crossing'", "'theta' differs"}},
       {"other ranks",
        with_nodes(&Factors::crossing, 4, {0, 0.7, 1}),
        {"'crossing'", "'facet_rank' differs"}},
       {"base IOR below 1", with_nodes(&Factors::crossing, 0, {0.9, 1.5}), {"'base_ior'", "1 to 5"}},
       {"depth below 0", with_nodes(&Factors::crossing, 1, {-1, 1}), {"'optical_depth'", "0 to"}},
       {"cosine above 1", with_value(&Factors::facet_cosine, 1.1), {"'facet_cosine' leaves"}},
       {"falling cosines", with_value(&Factors::facet_cosine, 0.0), {"'facet_cosine' falls from", "to rise"}},
       {"more than all light", with_value(&Factors::crossing, 2e6), {"'crossing' leaves -100 to 1e+06"}},
       {"less than none", with_value(&Factors::crossing, -101), {"'crossing' leaves -100 to 1e+06"}}});
  expect_named(
      layered_table(material_of({0.3, 0.1}, AbsorptionPath::sum), test::layered_waves()),
      {{"one azimuth", with_nodes(&Factors::facet_cosine, 1, {0}), {"'phi' runs from 0 to 0", "1.57"}}});
}

TEST(LayeredReader, NamesDefectsOfReturns) {
  const Change white = [](Table& table) {
    table.factors.wavelengths.albedo[2] = 1;
    table.factors.returning.values().back() = 1;
  };
  expect_named(
      layered_table(material_of(0, AbsorptionPath::sum), test::layered_waves()),
      {{"no cosines", under_another_name(&Factors::return_cosine), {"'return_cosine' is missing"}},
       {"no returns", under_another_name(&Factors::returning), {"'returning' is missing"}},
       {"renamed axis", with_name(&Factors::returning, 0, "depth"), {"'depth'", "'optical_depth'"}},
       {"an axis too few", without_last_axis(&Factors::returning), {"'returning' has 1 axes", "expected 2"}},
       {"colours", in_colours(&Factors::return_cosine), {"'return_cosine' holds colours"}},
       {"ranks to 2", with_nodes(&Factors::return_cosine, 0, {0, 2}), {"'facet_rank' runs from 0 to 2"}},
       {"one rank", with_nodes(&Factors::return_cosine, 0, {1}), {"'facet_rank' runs from 1 to 1"}},
       {"other ranks", with_nodes(&Factors::returning, 1, {0, 1}), {"'returning'", "'facet_rank' differs"}},
       {"depth below 0", with_nodes(&Factors::returning, 0, {-1, 1}), {"'optical_depth'", "0 to"}},
       {"cosine below 0",
        [](Table& table) { table.factors.return_cosine.values()[0] = -0.1f; },
        {"'return_cosine' leaves"}},
       {"falling cosines", with_value(&Factors::return_cosine, 0), {"'return_cosine' falls from"}},
       {"more than left", with_value(&Factors::returning, 1.1), {"'returning' leaves 0 to 1"}},
       {"less than nothing", with_value(&Factors::returning, -0.1), {"'returning' leaves 0 to 1"}},
       {"all of a white base", white, {"'returning' times attribute 'spectral.albedo' reaches 1"}}});
}

TEST(LayeredReader, NamesDefectsOfExchange) {
  const auto without_wavelengths = [](Table& table) {
    auto axes = table.factors.exchange.axes();
    axes.erase(axes.begin() + 3);
    table.factors.exchange = test::rebuilt(table.factors.exchange, axes);
  };
  expect_named(layered_product(),
               {{"no exchange", under_another_name(&Factors::exchange), {"'exchange' is missing"}},
                {"that of a single film", without_wavelengths, {"'exchange' has 8 axes", "expected 9"}},
                {"invisible light",
                 with_nodes(&Factors::exchange, 3, {200, 500}),
                 {"'wavelength_nm' leaves 300 to 1000"}},
                {"horizon", with_nodes(&Factors::exchange, 7, {0, 1}), {"'cos_theta_o'", "to 1"}},
                {"azimuth", with_nodes(&Factors::exchange, 6, {0, 1}), {"'phi_i' has 2"}},
                {"wi and wo at other cosines",
                 with_nodes(&Factors::exchange, 7, {0.5, 1}),
                 {"'cos_theta_i'", "'cos_theta_o'"}},
                {"below the exterior",
                 [](Table& table) { table.material.exterior_ior = 1.5; },
                 {"'exchange'", "'cos_theta_i'", "'warped_cos_i'"}}});
}

TEST(LayeredReader, NamesDefectsOfTheLayers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto periods = [](int count) {
    return with_wavelengths([=](Wavelengths& waves) { waves.film_periods = count; });
  };
  const auto thickness = [](double nm) {
    return with_layer(1, [=](FilmLayer& layer) { layer.thickness_nm = nm; });
  };
  const auto all_thick = [](double nm) {
    return with_wavelengths([=](Wavelengths& waves) {
      for (auto& layers : waves.layers)
        for (FilmLayer& layer : layers) layer.thickness_nm = nm;
    });
  };
  const auto index = [](std::complex<double> value) {
    return with_layer(1, [=](FilmLayer& layer) { layer.index = value; });
  };
  expect_named(
      layered_table(),
      {{"no period", periods(0), {"'film.periods' is '0'", "1 to 1000"}},
       {"periods without number", with_attribute("film.periods", "3.5"), {"'film.periods' is '3.5'"}},
       {"no periods", with_attribute("film.periods", ""), {"'film.periods' is ''"}},
       {"too many layers", periods(501), {"'film.*' describe 1002 layers", "1 to 1000"}},
       {"negative thickness", thickness(-1), {"'film.1.thickness_nm' holds -1", "0 to 1e+05"}},
       {"thick layer", thickness(2e5), {"'film.1.thickness_nm' holds 2e+05", "0 to 1e+05"}},
       {"thickness without number",
        with_attribute("film.1.thickness_nm", "nan"),
        {"'film.1.thickness_nm' holds 'nan'"}},
       {"list of thicknesses",
        with_attribute("film.1.thickness_nm", "1 2"),
        {"'film.1.thickness_nm' is a list"}},
       {"thick layers", all_thick(5e4), {"'film.*.thickness_nm' add up to 3e+05", "film of 400 nm"}},
       {"no thickness", all_thick(0), {"'film.*.thickness_nm' add up to 0", "film of 400 nm"}},
       {"hardly a thickness", all_thick(1e-310), {"'film.*.thickness_nm' add up to 6", "1e-300"}},
       {"index near 0", index(0.04), {"'film.1.n' holds 0.04", "0.05 to 10"}},
       {"large index", index(11), {"'film.1.n' holds 11", "0.05 to 10"}},
       {"layers that shine", index({1.5, -0.1}), {"'film.1.k' holds -0.1", "0 to 100"}},
       {"large extinction", index({1.5, 101}), {"'film.1.k' holds 101", "0 to 100"}},
       {"index without number", index({1.5, kNan}), {"'film.1.k' holds 'nan'"}},
       {"too few indices",
        with_attribute("film.0.n", "1.5 1.5"),
        {"'film.0.n' holds 2 numbers", "wavelength, 5"}},
       {"half a layer", with_attribute("film.2.k", "0 0 0 0 0"), {"'film.2.thickness_nm' is missing"}},
       {"stray layer", with_attribute("film.3.k", "0 0 0 0 0"), {"'film.3.k' is there"}},
       {"another name", with_attribute("film.color", "red"), {"'film.color' is there"}},
       {"a path of many wavelengths",
        with_grid(0,
                  [](Axis& axis) {
                    axis.nodes = {0, 5e4};
                  }),
        {"film_thickness_nm reaches a path 2 sum(n d) of", "wavelengths at 400 nm", "up to 50"}},
       {"an index of the base alone",
        with_attribute("base.n", "1.5 1.5 1.5 1.5 1.5"),
        {"'base.k' is missing"}}});
}

// A spread evaluates the film at many thicknesses.
TEST(LayeredReader, ManyUnevenLayers) {
  Table table = layered_table();
  for (auto& layers : table.factors.wavelengths.layers) layers.resize(900, {1, 1.5});
  table.factors.wavelengths.film_periods = 1;
  expect_named(table, {{"spread",
                        [](Table& t) { t.material.thickness_spread = 0.1; },
                        {"'film.*' hold 4500 indices", "thickness_spread: up to 4096"}}});
}

// Layers of no thickness are a film of none.
TEST(LayeredReader, AFilmOfNoThickness) {
  Table table = layered_table();
  for (auto& layers : table.factors.wavelengths.layers)
    for (FilmLayer& layer : layers) layer.thickness_nm = 0;
  table.factors.grid[0].nodes = {0};
  for (const Form& form : forms()) EXPECT_EQ(refusal(form, form.bytes(table), kName), "accepted");
}

TEST(LayeredReader, NamesDefectsOfTheBase) {
  const auto base = [](std::complex<double> index) {
    return with_wavelengths([=](Wavelengths& waves) { waves.base_index[3] = index; });
  };
  const auto grid_to = [](double ior) { return [=](Table& table) { table.factors.grid[1].nodes = {ior}; }; };
  expect_named(test::layered_dispersive_table(),
               {{"index below 1", base(0.9), {"'base.n' holds 0.9", "1 to 5"}},
                {"it absorbs", base({1.5, 0.1}), {"'base.k' holds 0.1", "0 to 0"}},
                {"two base IORs",
                 with_grid(1,
                           [](Axis& axis) {
                             axis.nodes = {1.4, 1.5};
                           }),
                 {"'base_ior' has 2 nodes", "'base.*'"}}});
  expect_named(
      test::layered_opaque_table(),
      {{"index near 0", base({0.01, 1}), {"'base.n' holds 0.01", "0.05 to 10"}},
       {"index above 10", base({11, 1}), {"'base.n' holds 11", "0.05 to 10"}},
       {"it shines", base({1, -1}), {"'base.k' holds -1", "0 to 100"}},
       {"grid below 0.05", grid_to(0.01), {"'base_ior' leaves 0.05 to 10"}},
       {"grid above 10", grid_to(11), {"'base_ior' leaves 0.05 to 10"}},
       {"clear after all",
        [](Table& table) { table.material.base_extinction = 0; },
        {"'base_ior'", "0.3", "1 to 5"}},
       {"light below", [](Table& table) { table.material.albedo = Rgb(0.5); }, {"'albedo'", "opaque base"}},
       {"no returns", under_another_name(&Factors::returning), {"'returning' is missing"}}});
}

TEST(LayeredReader, NamesVersionsThatDoNotFit) {
  expect_named(test::small_factored_table(),
               {{"nothing layered",
                 [](Table& table) { table.schema_version = 4; },
                 {"schema version is 4", "one clear layer", "expected 3"}},
                {"layers in version 3", with_attribute("film.periods", "1"), {"'film.periods' is there"}},
                {"a base in version 3", with_attribute("base.n", "1 1 1 1 1"), {"'base.n' is there"}},
                {"spread in version 3",
                 with_attribute("material.thickness_spread", "0.1"),
                 {"'material.thickness_spread' is there", "schema version 3"}}});
  expect_named(test::layered_dense_table(false),
               {{"layers of a dense table", with_attribute("film.periods", "1"), {"'film.periods' is there"}},
                {"no transmittance",
                 [](Table& table) { table.film_transmittance = NdArray(); },
                 {"'film_transmittance' is missing"}},
                {"no frame",
                 [](Table& table) { table.frame = FrameKind::none; },
                 {"'rest_frame' is 'none'", "schema version 4: closed"}}});
}

// The key under another name of equal length.
TEST(LayeredReader, MissingKeysOfVersion4) {
  for (const Form& form : forms())
    for (const std::string key : {"thickness_spread", "base_extinction"}) {
      std::string bytes = form.bytes(layered_table());
      const std::string name = "sunbeam.material." + key;
      bytes.replace(bytes.find(name), name.size(), name.substr(0, name.size() - 1) + "_");
      if (form.name == "vdb") bytes.replace(21, 36, "01234567-89ab-4def-8123-456789abcdef");
      EXPECT_THAT(refusal(form, bytes, kName),
                  AllOf(StartsWith(kName), HasSubstr("'material." + key + "' is missing")))
          << form.name;
    }
}

TEST(LayeredReader, SurvivesFlippedBits) {
  const Table tables[] = {layered_table(), layered_product(), test::layered_opaque_table()};
  for (std::size_t k = 0; k < std::size(tables); ++k) test::expect_survives_flipped_bits(tables[k], k);
}

TEST(LayeredReader, SurvivesTruncation) { test::expect_survives_truncation(layered_table()); }

}  // namespace
}  // namespace sunbeam
