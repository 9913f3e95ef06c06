// Tables of layered films in both file forms: what is written is what is read, film and arrays, bit for bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/error_of.h"
#include "tests/table/layered_tables.h"

namespace sunbeam {
namespace {

using test::forms;
using test::layered_tables;
using ::testing::AllOf;
using ::testing::HasSubstr;

void expect_same_bits(const Table& a, const Table& b) {
  const auto mine = a.arrays(), others = b.arrays();
  ASSERT_EQ(mine.size(), others.size());
  for (std::size_t k = 0; k < mine.size(); ++k) {
    const std::span<const float> x = mine[k]->values(), y = others[k]->values();
    ASSERT_EQ(x.size(), y.size()) << mine[k]->name();
    EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size_bytes()), 0) << mine[k]->name();
  }
}

TEST(LayeredFile, RoundTripIsTheSameTable) {
  for (const auto& form : forms())
    for (const Table& table : layered_tables()) {
      const Table loaded = form.parse(form.bytes(table), "t");
      EXPECT_EQ(loaded.schema_version, 4) << form.name;
      EXPECT_TRUE(loaded == table) << form.name;
      EXPECT_EQ(loaded.material.base_extinction, table.material.base_extinction);
      EXPECT_EQ(loaded.material.thickness_spread, table.material.thickness_spread);
      EXPECT_EQ(loaded.factors, table.factors) << form.name;
      expect_same_bits(loaded, table);
      EXPECT_TRUE(form.bytes(loaded) == form.bytes(table)) << form.name;
    }
}

TEST(LayeredFile, ConversionLosesNothing) {
  for (const Table& table : layered_tables()) {
    const std::string exr = table_exr_bytes(table), vdb = table_vdb_bytes(table);
    EXPECT_TRUE(table_vdb_bytes(parse_table_exr(exr, "t")) == vdb);
    EXPECT_TRUE(table_exr_bytes(parse_table_vdb(vdb, "t")) == exr);
  }
}

TEST(LayeredFile, TablesThatDifferAnywhereAreNotEqual) {
  const Table table = test::layered_table();
  std::vector<Table> others(8, table);
  Wavelengths& waves = others[0].factors.wavelengths;
  for (auto& layers : waves.layers) layers[1].thickness_nm += 1e-9;
  others[1].factors.wavelengths.layers[4][0].index.real(1.66);
  others[2].factors.wavelengths.layers[4][0].index.imag(1e-9);
  others[3].factors.wavelengths.film_periods = 4;
  others[4].factors.facet_cosine.values()[3] += 1e-6f;
  others[5].factors.crossing.values()[3] += 1e-6f;
  others[6].factors.return_cosine.values()[3] += 1e-6f;
  others[7].factors.returning.values()[3] += 1e-6f;
  for (std::size_t k = 0; k < others.size(); ++k) {
    EXPECT_FALSE(others[k] == table) << k;
    for (const auto& form : forms()) EXPECT_FALSE(form.bytes(others[k]) == form.bytes(table)) << k;
  }
}

// As many as a film may have, at as many wavelengths.
TEST(LayeredFile, ManyLayers) {
  Table table = test::layered_table();
  Wavelengths& waves = table.factors.wavelengths;
  const std::size_t count = kMostWavelengths;
  waves = {std::vector(count, 500.0), std::vector(count, 0.5), std::vector(count, 1.0),
           std::vector(count, Rgb(1.0 / 64))};
  Rng rng(3, 5);
  for (std::size_t j = 0; j < 1000; ++j) {
    const double thickness = rng.uniform();
    waves.layers.resize(count);
    for (auto& layers : waves.layers) layers.push_back({thickness, {1 + rng.uniform(), rng.uniform()}});
  }
  for (const auto& form : forms()) {
    const Table loaded = form.parse(form.bytes(table), "t");
    EXPECT_EQ(loaded.factors.wavelengths, waves) << form.name;
  }
}

// A reader of version 3 would take the film for another.
TEST(LayeredWriter, RefusesLayersInVersion3) {
  for (const auto& form : forms()) {
    Table table = test::layered_table();
    table.schema_version = 3;
    EXPECT_THAT(test::error_of([&] { form.bytes(table); }),
                AllOf(HasSubstr("layers"), HasSubstr("schema version 3")));
    table.factors.wavelengths.layers.clear();
    table.material.thickness_spread = 0.1;
    EXPECT_THAT(test::error_of([&] { form.bytes(table); }), HasSubstr("'thickness_spread'"));
  }
}

TEST(LayeredWriter, RefusesLayersThatAreNotAsThickAtEveryWavelength) {
  Table table = test::layered_table();
  table.factors.wavelengths.layers[2][1].thickness_nm = 51;
  for (const auto& form : forms())
    EXPECT_THAT(test::error_of([&] { form.bytes(table); }), HasSubstr("not as thick at every wavelength"));
  table.factors.wavelengths.layers[2].pop_back();
  for (const auto& form : forms())
    EXPECT_THAT(test::error_of([&] { form.bytes(table); }), HasSubstr("not as thick at every wavelength"));
}

}  // namespace
}  // namespace sunbeam
