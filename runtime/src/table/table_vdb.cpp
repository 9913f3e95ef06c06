// Table <-> OpenVDB. One grid an array, of Vec3f, or of floats for single numbers, at index coordinates
//   x = cell within the last two axes, y = cell within the two before, z = cell within the rest (row-major);
// attributes of the table as file metadata, of an array as grid metadata. The background is 0, so a value
// that is exactly 0 may be inactive: any accessor reads it right.
//
// The format asks for a UUID in the header (bytes 21 to 56). The library draws it at random; we replace it by
// a version 8 (custom) UUID made of the hash of all other bytes: equal tables give equal files, and damage is
// found before anything else is looked at. A file that another tool has written anew has its own UUID. The
// structure of both is checked before the library parses a byte.
#include "sunbeam/table_vdb.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <istream>
#include <sstream>
#include <streambuf>
#include <utility>

#include "runtime/src/base/attempt.h"
#include "runtime/src/table/table_parts.h"
#include "runtime/src/vdb/memory_claim.h"
#include "runtime/src/vdb/vdb_structure.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/hash.h"
#include "sunbeam/table_io.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::size_t kVersionDigit = 14;

struct GridSize {
  int x, y, z;
};

GridSize grid_size(const NdArray& array) {
  const auto& axes = array.axes();
  const std::size_t rank = axes.size();
  const auto cells_from = [&](std::size_t k) { return axes[k].size() * array.stride(k); };
  const std::size_t x = cells_from(rank >= 2 ? rank - 2 : 0);
  const std::size_t y = rank >= 4 ? cells_from(rank - 4) / x : rank == 3 ? cells_from(0) / x : 1;
  const std::size_t z = array.cells() / (x * y);
  constexpr std::size_t kLargest = 1u << 30;
  if (x > kLargest || y > kLargest || z > kLargest)
    throw Error("array '" + array.name() + "' is too large for a grid");
  return {static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)};
}

openvdb::CoordBBox box_of(const NdArray& array) {
  const GridSize size = grid_size(array);
  return {openvdb::Coord(0), openvdb::Coord(size.x - 1, size.y - 1, size.z - 1)};
}

// LayoutXYZ has x fastest, as a row-major array has its last axis.
template <class Grid>
auto dense_view(NdArray& array) {
  using Value = typename Grid::ValueType;
  return openvdb::tools::Dense<Value, openvdb::tools::LayoutXYZ>(
      box_of(array), reinterpret_cast<Value*>(array.values().data()));
}

template <class Grid>
openvdb::GridBase::Ptr filled_grid(NdArray& array) {
  const typename Grid::ValueType background(0);
  auto grid = Grid::create(background);
  openvdb::tools::copyFromDense(dense_view<Grid>(array), grid->tree(), background);
  return grid;
}

openvdb::GridBase::Ptr to_grid(NdArray& array) {
  const auto grid =
      array.channels() == 1 ? filled_grid<openvdb::FloatGrid>(array) : filled_grid<openvdb::Vec3SGrid>(array);
  grid->setName(array.name());
  grid->setSaveFloatAsHalf(array.precision() == Precision::half_float);
  for (const auto& [key, value] : describe_axes(array.axes()))
    grid->insertMeta(kAttributePrefix + key, openvdb::StringMetadata(value));
  grid->insertMeta(std::string(kAttributePrefix) + "precision",
                   openvdb::StringMetadata(array.precision() == Precision::half_float ? "half" : "float"));
  return grid;
}

Attributes string_attributes(const openvdb::MetaMap& metadata) {
  Attributes result;
  const std::string prefix = kAttributePrefix;
  for (auto at = metadata.beginMeta(); at != metadata.endMeta(); ++at)
    if (at->first.starts_with(prefix) && at->second->typeName() == openvdb::StringMetadata::staticTypeName())
      result[at->first.substr(prefix.size())] = at->second->str();
  return result;
}

template <class Grid>
void copy_voxels(const Grid& grid, NdArray& array) {
  const openvdb::CoordBBox active = grid.evalActiveVoxelBoundingBox();
  if (!active.empty() && !box_of(array).isInside(active))
    throw Error("grid '" + array.name() + "': its voxels do not agree with the axes");
  auto dense = dense_view<Grid>(array);
  openvdb::tools::copyToDense(grid, dense);
}

ArrayShape read_shape(const openvdb::GridBase& grid, std::size_t channels) {
  const std::string name = grid.getName();
  const Attributes attributes = string_attributes(grid);
  const auto at = attributes.find("precision");
  if (at == attributes.end())
    throw Error("grid '" + name + "' is not a table array: it has no sunbeam.precision");
  const std::string& precision = at->second;
  if (precision != "half" && precision != "float")
    throw Error("grid '" + name + "': sunbeam.precision is '" + precision + "'; allowed: half, float");
  return {name, parse_axes(attributes, name),
          precision == "half" ? Precision::half_float : Precision::single_float, channels};
}

template <class Grid>
NdArray to_array(const Grid& grid, MemoryClaim& memory) {
  ArrayShape shape = read_shape(grid, sizeof(typename Grid::ValueType) / sizeof(float));
  memory.add(shape.cells() * shape.channels() * sizeof(float));
  NdArray array(std::move(shape));
  copy_voxels(grid, array);
  return array;
}

NdArray to_array(const openvdb::GridBase& base, MemoryClaim& memory) {
  if (const auto* colors = dynamic_cast<const openvdb::Vec3SGrid*>(&base)) return to_array(*colors, memory);
  if (const auto* numbers = dynamic_cast<const openvdb::FloatGrid*>(&base)) return to_array(*numbers, memory);
  throw Error("grid '" + base.getName() + "' is of type " + base.type() + "; expected vec3s or float");
}

std::string uuid_from_content(std::string_view bytes) {
  ContentHash hash;
  hash.add(bytes.substr(0, kVdbUuidOffset));
  hash.add(std::string(kVdbUuidSize, '0'));
  hash.add(bytes.substr(kVdbUuidOffset + kVdbUuidSize));
  std::string uuid = hash.text();
  uuid[12] = '8';  // version 8, variant 1 (RFC 9562)
  uuid[16] = '8';
  for (const std::size_t dash : {8u, 13u, 18u, 23u}) uuid.insert(dash, "-");
  return uuid;
}

// Reads bytes in place.
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(std::string_view bytes) {
    char* begin = const_cast<char*>(bytes.data());
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::cur ? gptr() - eback()
                                                       : egptr() - eback();
    const off_type target = base + offset;
    if (target < 0 || target > egptr() - eback()) return pos_type(off_type(-1));
    setg(eback(), eback() + target, egptr());
    return target;
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(off_type(position), std::ios_base::beg, mode);
  }
};

// Grids go as soon as they are read.
TableParts read_parts(std::string_view bytes) {
  MemoryBuffer buffer(bytes);
  std::istream in(&buffer);
  in.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
  openvdb::io::Stream stream(in, /*delayLoad=*/false);
  TableParts parts;
  parts.attributes = string_attributes(*stream.getMetadata());
  MemoryClaim memory("reading the arrays", bytes.size());
  for (auto& grid : *stream.getGrids())
    parts.arrays.push_back(to_array(*std::exchange(grid, nullptr), memory));
  return parts;
}

void check_identifier(std::string_view bytes, const std::string& name) {
  if (!is_vdb(bytes)) throw Error(name + ": not an OpenVDB file");
  const std::string_view uuid = bytes.substr(kVdbUuidOffset, kVdbUuidSize);
  if (uuid[kVersionDigit] == '8' && !is_hash_of_content(uuid, uuid_from_content(bytes)))
    throw Error(name + ": the content does not match the file's identifier: it is damaged or cut short");
}

}  // namespace

std::string table_vdb_bytes(const Table& table) {
  openvdb::initialize();
  openvdb::MetaMap metadata;
  for (const auto& [key, value] : attributes_of(table))
    metadata.insertMeta(kAttributePrefix + key, openvdb::StringMetadata(value));
  openvdb::GridPtrVec grids;
  for (const NdArray* array : table.arrays()) {
    NdArray copy = *array;  // the library reads through a view that could write
    grids.push_back(to_grid(copy));
  }
  std::ostringstream out;
  openvdb::io::Stream stream(out);
  stream.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  stream.write(grids, metadata);
  std::string bytes = std::move(out).str();
  return bytes.replace(kVdbUuidOffset, kVdbUuidSize, uuid_from_content(bytes));
}

Table parse_table_vdb(std::string_view bytes, const std::string& name) {
  openvdb::initialize();
  check_identifier(bytes, name);
  TableParts parts;
  try {
    check_vdb_structure(bytes, std::string(kAttributePrefix) + "schema_version");
    parts = read_parts(bytes);
  } catch (const std::exception& error) {
    throw Error(name + ": cannot read the table: " + error.what());
  }
  return from_parts(std::move(parts), name);
}

Table load_table_vdb(const std::string& path) { return parse_table_vdb(read_file(path), path); }

void save_table_vdb(const Table& table, const std::string& path) {
  write_file_atomically(path, table_vdb_bytes(table));
}

void require_table_extension(const std::string& path) {
  const std::string ext = extension(path);
  if (ext != ".exr" && ext != ".vdb")
    throw Error(path + ": extension is '" + ext + "'; allowed for a table: .exr, .vdb");
}

Result<Table> try_load_table(const std::string& path) {
  return attempt([&] { return load_table(path); });
}

Table load_table(const std::string& path) {
  const std::string bytes = read_file(path);
  require_table_extension(path);
  return extension(path) == ".vdb" ? parse_table_vdb(bytes, path) : parse_table_exr(bytes, path);
}

std::string table_bytes(const Table& table, const std::string& path) {
  require_table_extension(path);
  return extension(path) == ".vdb" ? table_vdb_bytes(table) : table_exr_bytes(table);
}

void save_table(const TableView& table, const std::string& path) {
  require_table_extension(path);
  if (extension(path) == ".exr") return save_table_exr(table, path);
  std::optional<Table> room;
  save_table_vdb(table.whole(room), path);
}

}  // namespace v1
}  // namespace sunbeam
