// What is written is what is read, in both file forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "sunbeam/detail/file.h"
#include "sunbeam/detail/warp.h"
#include "sunbeam/table_bsdf.h"
#include "tests/support/error_of.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

using test::error_of;

using test::forms;
using test::small_table;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<Table> assorted_tables() {
  std::vector<Table> tables;
  for (const Precision precision : {Precision::half_float, Precision::single_float})
    for (const bool rough : {false, true}) tables.push_back(small_table(precision, rough));
  tables.push_back(small_table());
  tables.back().material.transmission = Transmission::straight;
  tables.back().material.absorption_path = AbsorptionPath::product;
  tables.back().material.film_ior = 1.0 / 3 + 1;  // no short decimal
  tables.push_back(test::small_anisotropic_table());
  tables.push_back(test::small_full_table());
  return tables;
}

TEST(TableFile, RoundTripIsTheSameTable) {
  for (const auto& form : forms())
    for (const Table& table : assorted_tables()) {
      const Table loaded = form.parse(form.bytes(table), "t");
      EXPECT_TRUE(loaded == table) << form.name;
      EXPECT_EQ(loaded.info, table.info) << form.name;
      // operator== takes -0 for 0; bits do not.
      const auto a = loaded.remainder.values(), b = table.remainder.values();
      EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0) << form.name;
    }
}

TEST(TableFile, TablesThatDifferAnywhereAreNotEqual) {
  const Table table = small_table();
  std::vector<Table> others(9, table);
  others[0].material.film_ior += 1e-15;
  others[1].symmetry = Symmetry::anisotropic;
  others[2].film_reflectance.set(4, Rgb(0.77));
  others[3].film_transmittance.set(4, Rgb(0.77));
  others[4].remainder.set(200, Rgb(0.77));
  others[5].rest_stderr.set(287, Rgb(0.77));
  others[6].info["seed"] = "8";
  others[7].first_visit = test::small_full_table().first_visit;
  others[8].frame = FrameKind::none;
  EXPECT_TRUE(table == small_table());
  for (std::size_t k = 0; k < others.size(); ++k) EXPECT_FALSE(others[k] == table) << k;
}

TEST(TableFile, ConversionLosesNothing) {
  for (const Table& table : assorted_tables()) {
    const std::string exr = table_exr_bytes(table), vdb = table_vdb_bytes(table);
    const std::string vdb_of_exr = table_vdb_bytes(parse_table_exr(exr, "t"));
    const std::string exr_of_vdb = table_exr_bytes(parse_table_vdb(vdb, "t"));
    EXPECT_TRUE(vdb_of_exr == vdb);
    EXPECT_TRUE(exr_of_vdb == exr);
  }
}

TEST(TableFile, SameTableSameBytes) {
  for (const auto& form : forms())
    for (const Table& table : assorted_tables())
      EXPECT_TRUE(form.bytes(table) == form.bytes(table)) << form.name;
}

TEST(TableFile, OtherTableOtherBytes) {
  for (const auto& form : forms()) {
    Table other = small_table();
    other.remainder.set(0, Rgb(0.77));
    EXPECT_FALSE(form.bytes(other) == form.bytes(small_table())) << form.name;
  }
}

// RFC 9562: 8-4-4-4-12 hexadecimal digits, version nibble 8 (custom), variant bits 10.
TEST(TableFile, VdbIdentifierIsACustomUuid) {
  const std::string uuid = table_vdb_bytes(small_table()).substr(21, 36);
  EXPECT_THAT(uuid,
              ::testing::MatchesRegex("[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}"));
  Table other = small_table();
  other.info["seed"] = "8";
  EXPECT_NE(table_vdb_bytes(other).substr(21, 36), uuid);
}

// Another tool that writes the grids anew gives the file an identifier of its own (version 4, random).
TEST(TableFile, VdbWithAForeignIdentifierIsRead) {
  std::string bytes = table_vdb_bytes(small_table());
  bytes.replace(21, 36, "01234567-89ab-4def-8123-456789abcdef");
  EXPECT_TRUE(parse_table_vdb(bytes, "t") == small_table());
}

// Values of either sign that halves round to zero, as the noise of a bake can be.
TEST(TableFile, ValuesThatRoundToZero) {
  for (const auto& form : forms())
    for (const double tiny : {1e-9, -1e-9, -0.0}) {
      Table table = small_table();
      for (std::size_t cell = 0; cell < 10; ++cell) table.remainder.set(cell, Rgb(tiny));
      EXPECT_EQ(test::refusal(form, form.bytes(table), "t"), "accepted") << form.name << ' ' << tiny;
    }
}

TEST(TableFile, AllZeroArrays) {
  for (const auto& form : forms()) {
    Table table = small_table();
    for (const auto array : {&Table::remainder, &Table::rest_stderr})
      for (float& value : (table.*array).values()) value = 0;
    EXPECT_TRUE(form.parse(form.bytes(table), "t") == table) << form.name;
  }
}

TEST(TableFile, SaveAndLoadByExtension) {
  const ScratchFolder folder;
  const Table table = small_table();
  for (const std::string name : {"a.exr", "a.vdb", "B.EXR", "B.Vdb"}) {
    save_table(table, folder.file(name));
    EXPECT_TRUE(load_table(folder.file(name)) == table) << name;
    EXPECT_TRUE(read_file(folder.file(name)) == table_bytes(table, name)) << name;
  }
  EXPECT_EQ(table_bytes(table, "x.exr"), table_exr_bytes(table));
  EXPECT_EQ(table_bytes(table, "x.vdb"), table_vdb_bytes(table));
  save_table_exr(table, folder.file("c.exr"));
  save_table_vdb(table, folder.file("c.vdb"));
  EXPECT_TRUE(load_table_exr(folder.file("c.exr")) == load_table_vdb(folder.file("c.vdb")));
  EXPECT_EQ(folder.names().size(), 6u);  // and nothing temporary
}

TEST(TableFile, RefusesOtherNames) {
  const ScratchFolder folder;
  const Table table = small_table();
  for (const std::string name : {"t.png", "t", "t.exr.txt"}) {
    EXPECT_THAT(error_of([&] { save_table(table, folder.file(name)); }),
                AllOf(HasSubstr(folder.file(name)), HasSubstr(".exr, .vdb")));
    write_file_atomically(folder.file(name), table_exr_bytes(table));
    EXPECT_THAT(error_of([&] { load_table(folder.file(name)); }),
                AllOf(HasSubstr(folder.file(name)), HasSubstr(".exr, .vdb")));
  }
  EXPECT_THAT(error_of([&] { load_table(folder.file("none.exr")); }), HasSubstr(folder.file("none.exr")));
  // The one form under the other's name.
  write_file_atomically(folder.file("swapped.vdb"), table_exr_bytes(table));
  write_file_atomically(folder.file("swapped.exr"), table_vdb_bytes(table));
  for (const std::string name : {"swapped.vdb", "swapped.exr"})
    EXPECT_THAT(error_of([&] { load_table(folder.file(name)); }),
                AllOf(HasSubstr(folder.file(name)), HasSubstr("not an Open")))
        << name;
}

TEST(TableFile, BsdfOfBothFormsIsTheSame) {
  const Table table = small_table();
  const Parameters between{233, 1.47, 0.1};
  const TableBsdf exr(parse_table_exr(table_exr_bytes(table), "t"), between);
  const TableBsdf vdb(parse_table_vdb(table_vdb_bytes(table), "t"), between);
  Rng a(1, 0), b(1, 0), directions(2, 0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 wo = sample_cosine({directions.uniform(), directions.uniform()});
    const Vec3 wi = sample_cosine({directions.uniform(), directions.uniform()});
    EXPECT_EQ(exr.eval(wo, wi, a), vdb.eval(wo, wi, b));
    EXPECT_EQ(exr.mis_pdf(wo, wi), vdb.mis_pdf(wo, wi));
    const auto s = exr.sample(wo, a), t = vdb.sample(wo, b);
    ASSERT_EQ(s.has_value(), t.has_value());
    if (!s) continue;
    EXPECT_EQ(s->throughput, t->throughput);
    EXPECT_EQ(s->wi.x, t->wi.x);
  }
}

}  // namespace
}  // namespace sunbeam
