// Factored tables in both file forms: what is written is what is read, bit for bit.
#include <gtest/gtest.h>

#include <cstring>

#include "sunbeam/detail/file.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

using test::factored_tables;
using test::forms;

// operator== takes -0 for 0; bits do not.
void expect_same_bits(const NdArray& a, const NdArray& b) {
  ASSERT_EQ(a.values().size(), b.values().size());
  if (!a.empty()) {
    EXPECT_EQ(std::memcmp(a.values().data(), b.values().data(), a.values().size_bytes()), 0) << a.name();
  }
}

TEST(FactoredFile, RoundTripIsTheSameTable) {
  for (const auto& form : forms())
    for (const Table& table : factored_tables()) {
      const Table loaded = form.parse(form.bytes(table), "t");
      EXPECT_TRUE(loaded.is_factored()) << form.name;
      EXPECT_TRUE(loaded == table) << form.name;
      EXPECT_EQ(loaded.info, table.info) << form.name;
      EXPECT_EQ(loaded.factors.grid, table.factors.grid) << form.name;
      EXPECT_EQ(loaded.factors.wavelengths, table.factors.wavelengths) << form.name;
      for (const auto array : {&Factors::arrival, &Factors::returned, &Factors::exchange})
        expect_same_bits(loaded.factors.*array, table.factors.*array);
    }
}

TEST(FactoredFile, ConversionLosesNothing) {
  for (const Table& table : factored_tables()) {
    const std::string exr = table_exr_bytes(table), vdb = table_vdb_bytes(table);
    EXPECT_TRUE(table_vdb_bytes(parse_table_exr(exr, "t")) == vdb);
    EXPECT_TRUE(table_exr_bytes(parse_table_vdb(vdb, "t")) == exr);
  }
}

TEST(FactoredFile, SaveAndLoadByExtension) {
  const ScratchFolder folder;
  const Table table = test::small_factored_table();
  for (const std::string name : {"a.exr", "a.vdb"}) {
    save_table(table, folder.file(name));
    EXPECT_TRUE(load_table(folder.file(name)) == table) << name;
    EXPECT_TRUE(read_file(folder.file(name)) == table_bytes(table, name)) << name;
  }
}

// Values of either sign that halves round to zero, and arrays of nothing but zeros.
TEST(FactoredFile, Zeros) {
  for (const auto& form : forms())
    for (const double tiny : {0.0, -0.0, 1e-9, -1e-9}) {
      Table table = test::small_factored_table(0.3, AbsorptionPath::product);
      for (NdArray* array : {&table.factors.arrival, &table.factors.exchange})
        for (std::size_t cell = 0; cell < array->cells(); ++cell) array->set(cell, Rgb(tiny));
      EXPECT_TRUE(form.parse(form.bytes(table), "t") == table) << form.name << ' ' << tiny;
    }
}

TEST(FactoredFile, TablesThatDifferAnywhereAreNotEqual) {
  const Table table = test::small_factored_table();
  std::vector<Table> others(6, table);
  others[0].factors.grid[0].nodes[1] = 301;
  others[1].factors.wavelengths.weight[4].b = 1e-9;
  others[2].factors.arrival.set(7, Rgb(-0.77));
  others[3].factors.returned.set(7, Rgb(0.77));
  others[4].factors.exchange = test::small_factored_table(0.3, AbsorptionPath::product).factors.exchange;
  others[5].info["noise"] = "0.1";
  for (std::size_t k = 0; k < others.size(); ++k) {
    EXPECT_FALSE(others[k] == table) << k;
    for (const auto& form : forms()) EXPECT_FALSE(form.bytes(others[k]) == form.bytes(table)) << k;
  }
}

}  // namespace
}  // namespace sunbeam
