// OpenVDB's reader takes sizes and counts as a file states them. Ours looks at them first, whoever signed it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <sstream>

#include "sunbeam/detail/file.h"
#include "sunbeam/detail/hash.h"
#include "tests/support/scratch_folder.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

using test::expect_error_or_equal;
using test::Form;
using test::refusal;
using test::small_factored_table;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kName = "some.vdb";
constexpr std::size_t kUuid = 21, kUuidSize = 36;

Form vdb() { return test::forms()[1]; }

// The identifier that the writer would give these bytes, so that no hash gives a change away.
std::string signed_anew(std::string bytes) {
  bytes.replace(kUuid, kUuidSize, kUuidSize, '0');
  std::string uuid = content_hash(bytes);
  uuid[12] = '8';
  uuid[16] = '8';
  for (const std::size_t dash : {8u, 13u, 18u, 23u}) uuid.insert(dash, "-");
  return bytes.replace(kUuid, kUuidSize, uuid);
}

template <class Number>
std::string bytes_of(Number value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

// One grid of two leaf nodes, both of whose blocks are packed. All fields have a known place.
class OneGrid {
 public:
  static Table table() {
    Table table = small_factored_table(Roughness(0), AbsorptionPath::sum);
    std::ranges::fill(table.factors.returned.values(), 0.25f);
    return table;
  }
  const std::string& bytes() const { return bytes_; }

  std::size_t after(const std::string& text, std::size_t from = 0) const {
    return bytes_.find(text, from) + text.size();
  }
  // The places of sizes and values of a metadata entry.
  std::size_t size_of(const std::string& name, const std::string& type) const {
    return after(type, after(name, grid()));
  }
  std::size_t value_of(const std::string& name, const std::string& type) const {
    return size_of(name, type) + 4;
  }

  std::size_t grid_count() const { return grid() - 4 - 8 - 4 - 4; }
  std::size_t grid() const { return bytes_.find(kType); }
  std::size_t parent() const { return grid() + kType.size(); }
  std::size_t offsets() const { return parent() + 4; }
  std::size_t compression() const { return offsets() + 24; }
  std::size_t transform() const { return bytes_.find("UniformScaleMap"); }
  std::size_t tree() const { return transform() + 15 + 120; }
  std::size_t place() const { return tree() + 16; }
  std::size_t upper() const { return place() + 12; }
  std::size_t upper_values() const { return upper() + 2 * 4096; }
  std::size_t lower() const { return upper_values() + 9; }
  std::size_t lower_values() const { return lower() + 2 * 512; }
  std::size_t leaf() const { return lower_values() + 9 + 2 * 64; }

  static inline const std::string kType = "Tree_float_5_4_3";

 private:
  std::string bytes_ = table_vdb_bytes(table());
};

struct Lie {
  std::size_t at;
  std::string instead;  // of as many bytes
  std::vector<std::string> named;
};

void expect_refused(const std::string& bytes, const std::vector<std::string>& named) {
  const std::string message = refusal(vdb(), signed_anew(bytes), kName);
  EXPECT_THAT(message, StartsWith(kName));
  for (const std::string& part : named) EXPECT_THAT(message, HasSubstr(part));
}

void expect_refused(const std::vector<Lie>& lies) {
  const OneGrid good;
  ASSERT_EQ(refusal(vdb(), signed_anew(good.bytes()), kName), "accepted");
  for (const Lie& lie : lies) {
    SCOPED_TRACE(lie.at);
    std::string bytes = good.bytes();
    ASSERT_NE(bytes.substr(lie.at, lie.instead.size()), lie.instead);
    expect_refused(bytes.replace(lie.at, lie.instead.size(), lie.instead), lie.named);
  }
}

TEST(VdbStructure, Header) {
  expect_refused({{8, bytes_of(221u), {"version", "221", "222 to 224"}},
                  {8, bytes_of(225u), {"version", "225", "222 to 224"}},
                  {20, "\2", {"offsets", "2"}},
                  {57, bytes_of(0xffffffffu), {"metadata", "4294967295", "10000"}}});
  std::string bytes = OneGrid().bytes();
  bytes.replace(kUuid, kUuidSize, "01 45678-9abc-4def-8123-456789abcdef");
  EXPECT_THAT(refusal(vdb(), bytes, kName), AllOf(StartsWith(kName), HasSubstr("UUID is '01 45")));
}

TEST(VdbStructure, FileMetadata) {
  const OneGrid good;
  const std::size_t name = good.bytes().find("sunbeam.content_hash");
  const std::size_t type = name + 20 + 4, size = type + 6;
  expect_refused({{name - 4, bytes_of(0xfffffff0u), {"name of a metadata entry", "4294967280"}},
                  {type - 4, bytes_of(0x80000000u), {"type of a metadata entry", "2147483648"}},
                  {type, "strung", {"sunbeam.content_hash", "'strung'"}},
                  {type, "double", {"sunbeam.content_hash", "double", "8 bytes", "32"}},
                  {size, bytes_of(0xfffffff0u), {"value of a metadata entry", "4294967280", "left"}}});
}

TEST(VdbStructure, MetadataOfAGrid) {
  const OneGrid good;
  const std::size_t half = good.value_of("is_saved_as_half_float", "bool");
  const std::size_t leaves = good.value_of("file_delayed_load", "__delayedload");
  expect_refused(
      {{half, "\2", {"'returned'", "is_saved_as_half_float", "2"}},
       {half, "\1", {"'returned'", "halves"}},
       {half - 4, bytes_of(2u), {"is_saved_as_half_float", "bool", "1 byte", "2"}},
       {good.size_of("file_voxel_count", "int64"), bytes_of(4u), {"file_voxel_count", "8 bytes", "4"}},
       {leaves, bytes_of(0xfffffff0u), {"file_delayed_load", "leaf nodes", "left"}},
       {leaves + 4, bytes_of(0x7fffffffu), {"file_delayed_load", "leaf nodes", "left"}}});
}

TEST(VdbStructure, Descriptor) {
  const OneGrid good;
  expect_refused({{good.grid_count(), bytes_of(-1), {"number of grids", "-1"}},
                  {good.grid_count(), bytes_of(1 << 30), {"number of grids", "1073741824", "64"}},
                  {good.grid_count(), bytes_of(2), {"the file ends", "name of a grid"}},
                  {good.grid_count(), bytes_of(0), {"follow the last grid"}},
                  {good.grid_count() + 4, bytes_of(0xffffffffu), {"name of a grid", "4294967295"}},
                  {good.grid() - 4, bytes_of(0x7fffffffu), {"type of a grid", "2147483647"}},
                  {good.grid(), "Tree_int32_5_4_3", {"'returned'", "Tree_int32_5_4_3", "vec3s or float"}},
                  {good.grid(), "Tree_float_4_3_2", {"'returned'", "Tree_float_4_3_2", "vec3s or float"}},
                  {20, "\1", {"'returned'", "states its grid at byte 0", "found at"}},
                  {good.compression(), bytes_of(8u), {"'returned'", "compression 8"}},
                  {good.compression(), bytes_of(1u), {"'returned'", "block of values"}},
                  {good.compression(), bytes_of(2u), {"'returned'"}},
                  {good.transform(), "UniformScaleMop", {"'returned'", "'UniformScaleMop'", "linear"}},
                  {good.transform() - 4, bytes_of(0xffffffffu), {"type of a transform", "4294967295"}}});
  std::string bytes = good.bytes();
  expect_refused(bytes.replace(good.parent(), 4, bytes_of(1u) + "x"), {"'returned'", "another grid"});
  bytes = good.bytes();
  expect_refused(bytes.replace(good.transform() - 4, 4 + 15, bytes_of(19u) + "NonlinearFrustumMap"),
                 {"'returned'", "'NonlinearFrustumMap'", "linear"});
  expect_refused(good.bytes() + "abc", {"3 bytes follow the last grid"});
}

TEST(VdbStructure, Nodes) {
  const OneGrid good;
  expect_refused({{good.tree(), bytes_of(2), {"buffers", "2"}},
                  {good.tree() + 8, bytes_of(0xffffffffu), {"root"}},
                  {good.tree() + 12, bytes_of(2u), {"'returned'"}},
                  {good.tree() + 12, bytes_of(0xffffffffu), {"'returned'"}},
                  {good.place(), bytes_of(1), {"root", "at 1", "4096"}},
                  {good.place() + 4, bytes_of(-4096), {"root", "at -4096"}},
                  {good.place() + 8, bytes_of(1 << 30), {"root", "1073741824"}},
                  {good.upper() + 4000, "\1", {"'returned'"}},  // a child that is not there
                  {good.upper() + 4096, "\1", {"a child and an active value"}},
                  {good.upper() + 4096, "\2", {"block of values", "-4"}},
                  {good.upper_values(), "\7", {"kind 7"}},
                  {good.upper_values() + 1, bytes_of(std::int64_t{-4}), {"block of values", "-4"}},
                  {good.lower() + 511, "\x80", {"'returned'"}},
                  {good.lower_values(), "\xff", {"kind 255"}},
                  {good.lower_values() + 1, bytes_of(std::int64_t{-16384}), {"block of values", "-16384"}}});
}

TEST(VdbStructure, Blocks) {
  const OneGrid good;
  const std::size_t size = good.leaf() + 65;
  constexpr auto kLowest = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t lie :
       {kLowest, std::numeric_limits<std::int64_t>::max(), std::int64_t{-1}, std::int64_t{-2049},
        std::int64_t{0}, std::int64_t{1} << 40, std::int64_t{100000}})
    expect_refused({{size, bytes_of(lie), {"'returned'", "block of values"}}});
  expect_refused(
      {{good.leaf(), std::string(64, '\xff'), {"decompress"}}, {good.leaf() + 64, "\7", {"kind 7"}}});
}

// The place of a tile that the inner node keeps in a packed block of its own.
TEST(VdbStructure, PackedTilesThatDoNotUnpack) {
  const OneGrid good;
  std::string bytes = good.bytes();
  bytes[good.upper() + 4096 + 100] = 1;
  bytes.replace(good.upper_values() + 1, 8, bytes_of(std::int64_t{5}) + "noise");
  expect_refused(bytes, {"'returned'", "decompress"});
}

// A leaf node of zeros takes 64 bytes of the nodes' part, and 2 kB of memory.
TEST(VdbStructure, NodesBeyondTheLimitOfMemory) {
  const OneGrid good;
  const std::string lower = std::string(512, '\xff') + std::string(512 + 9 + 4096 * 64, '\0');
  std::string bytes =
      good.bytes().substr(0, good.upper()) + std::string(18, '\xff') + std::string(2 * 4096 - 18 + 9, '\0');
  for (int k = 0; k < 144; ++k) bytes += lower;
  expect_refused(bytes, {"'returned'", "reading the grids", "of memory"});
}

TEST(VdbStructure, AxesBeyondTheLimitOfMemory) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("returned");
  std::string nodes = "0";
  for (int k = 1; k < 700; ++k) nodes += " " + std::to_string(k);
  for (const std::string axis : {"0", "1", "2"})
    for (const auto& [key, value] : {std::pair("name", "a"),
                                     {"unit", "1"},
                                     {"power", "1"},
                                     {"period", "0"},
                                     {"origin", "0"},
                                     {"interpolation", "linear"},
                                     {"nodes", nodes.c_str()}})
      grid->insertMeta("sunbeam.axis." + axis + "." + key, openvdb::StringMetadata(value));
  grid->insertMeta("sunbeam.precision", openvdb::StringMetadata("float"));
  openvdb::MetaMap metadata;
  metadata.insertMeta("sunbeam.schema_version", openvdb::StringMetadata("3"));
  std::ostringstream out;
  openvdb::io::Stream(out).write(openvdb::GridPtrVec{grid}, metadata);
  expect_refused(out.str(), {"reading the arrays", "1372 MB of memory"});
}

// As other tools write a table anew: with offsets or without, packed in any way.
using Change = std::function<void(openvdb::GridBase&)>;

struct Written {
  std::uint32_t compression;
  bool as_stream;
};

std::string written_anew(const std::string& bytes, const Written& how, const Change& change = {}) {
  std::istringstream in(bytes);
  openvdb::io::Stream read(in, /*delayLoad=*/false);
  const auto grids = read.getGrids();
  if (change)
    for (const auto& grid : *grids) change(*grid);
  if (how.as_stream) {
    std::ostringstream out;
    openvdb::io::Stream stream(out);
    stream.setCompression(how.compression);
    stream.write(*grids, *read.getMetadata());
    return out.str();
  }
  const ScratchFolder folder;
  openvdb::io::File file(folder.file("anew.vdb"));
  file.setCompression(how.compression);
  file.write(*grids, *read.getMetadata());
  file.close();
  return read_file(folder.file("anew.vdb"));
}

std::vector<Written> ways_to_write() {
  std::vector<Written> ways;
  for (const std::uint32_t compression : {0u, 1u, 2u, 3u, 4u, 6u})
    if (compression < 4 || openvdb::io::Archive::hasBloscCompression())
      for (const bool as_stream : {true, false}) ways.push_back({compression, as_stream});
  return ways;
}

void expect_read_right(const Table& table, const Change& change = {}) {
  openvdb::initialize();
  const std::string bytes = table_vdb_bytes(table);
  for (const Written& how : ways_to_write())
    EXPECT_TRUE(parse_table_vdb(written_anew(bytes, how, change), "t") == table)
        << "compression " << how.compression << (how.as_stream ? ", stream" : ", file");
}

TEST(VdbStructure, FilesOfOtherToolsAreReadRight) {
  for (const Table& table : {small_factored_table(), test::small_table(), test::small_anisotropic_table(),
                             small_factored_table(0.3, AbsorptionPath::product, Precision::single_float)})
    expect_read_right(table);
}

// Equal values fill whole nodes and are stored once, in the node above.
TEST(VdbStructure, TilesAreReadRight) {
  std::vector<double> nodes;
  for (int k = 1; k <= 16; ++k) nodes.push_back(k / 16.0);
  auto axes = test::small_rest_axes();
  axes[0] = test::axis("film_thickness_nm", nodes);
  axes[3] = test::axis("cos_theta_i", nodes);
  axes[5] = test::axis("cos_theta_o", nodes);
  for (const Precision precision : {Precision::half_float, Precision::single_float}) {
    Table table = test::small_table(precision);
    table.remainder = NdArray("remainder", axes, precision);
    table.rest_stderr = NdArray("rest_stderr", axes, precision, 1);
    std::ranges::fill(table.remainder.values(), 0.25f);
    std::ranges::fill(table.rest_stderr.values(), 0.125f);
    expect_read_right(table);
  }
}

// Values that are not active are stored in other ways, depending on how many differ.
TEST(VdbStructure, InactiveValuesAreReadRight) {
  for (const Precision precision : {Precision::half_float, Precision::single_float})
    for (const int count : {1, 2, 3})
      for (const bool has_zero : {false, true}) {
        Table table = small_factored_table(0.3, AbsorptionPath::sum, precision);
        for (NdArray* array : {&table.factors.arrival, &table.factors.returned})
          for (float& value : array->values())
            if (value == 0 && !has_zero) value = 0.5f;
        expect_read_right(table, [&](openvdb::GridBase& grid) {
          auto& tree = dynamic_cast<openvdb::FloatGrid&>(grid).tree();
          for (auto leaf = tree.beginLeaf(); leaf; ++leaf) {
            int left = count;
            for (auto value = leaf->beginValueOn(); value && left > 0; ++value, --left) value.setValueOff();
          }
        });
      }
}

// Offsets, and Blosc's own header, in which the library trusts.
TEST(VdbStructure, FieldsOfOtherTools) {
  openvdb::initialize();
  if (!openvdb::io::Archive::hasBloscCompression()) GTEST_SKIP() << "OpenVDB has no Blosc here";
  const OneGrid good;
  const std::string anew = written_anew(good.bytes(), {6, false});
  const std::size_t offsets = anew.find(OneGrid::kType) + 16 + 4;
  for (const std::size_t which : {0u, 1u, 2u}) {
    std::string bytes = anew;
    ++bytes[offsets + 8 * which];
    expect_refused(bytes, {"'returned'", "states its"});
  }
  const std::size_t block = anew.rfind("\2\1");  // Blosc's version, then that of LZ4
  ASSERT_EQ(anew.substr(block - 8, 8), bytes_of(static_cast<std::int64_t>(anew.size() - block)));
  for (const std::size_t field : {4u, 8u, 12u}) {
    std::string bytes = anew;
    expect_refused(bytes.replace(block + field, 4, bytes_of(0x7fffffffu)), {"'returned'", "Blosc"});
  }
}

TEST(VdbStructure, SurvivesEveryChangedByteOfASignedFile) {
  const Table table = OneGrid::table();
  const std::string bytes = OneGrid().bytes();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (at % 2 ? 0x80 : 0x01));
    expect_error_or_equal(vdb(), signed_anew(damaged), kName, table, "byte " + std::to_string(at));
  }
}

}  // namespace
}  // namespace sunbeam
