#include "runtime/src/vdb/vdb_structure.h"

#include <cctype>
#include <utility>

#include "runtime/src/vdb/vdb_blocks.h"
#include "runtime/src/vdb/vdb_metadata.h"
#include "runtime/src/vdb/vdb_tree.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::string_view kMagic(" BDV\0\0\0\0", 8);
constexpr std::uint32_t kOldestVersion = 222, kNewestVersion = 224;
constexpr std::int32_t kMostGrids = 64;
constexpr std::uint32_t kLongestName = 1000;

std::string quoted(std::string_view text) { return "'" + printable(text) + "'"; }

// Of bytes that is_vdb() takes. Returns whether grids state where they are in the file.
bool walk_header(ByteCursor& in) {
  in.take(kMagic.size(), "the header");
  const auto version = in.number<std::uint32_t>("the header");
  if (version < kOldestVersion || version > kNewestVersion)
    throw Error("the version of OpenVDB's format is " + std::to_string(version) +
                "; allowed: " + std::to_string(kOldestVersion) + " to " + std::to_string(kNewestVersion));
  in.take(8, "the version of the library");
  const auto has_offsets = in.number<std::uint8_t>("the header");
  if (has_offsets > 1)
    throw Error("the flag of offsets is " + std::to_string(has_offsets) + "; allowed: 0 and 1");
  const std::string_view uuid = in.take(kVdbUuidSize, "the UUID");
  for (std::size_t k = 0; k < uuid.size(); ++k)
    if (k == 8 || k == 13 || k == 18 || k == 23 ? uuid[k] != '-'
                                                : !std::isxdigit(static_cast<unsigned char>(uuid[k])))
      throw Error("the UUID is " + quoted(uuid) + "; expected hexadecimal digits with dashes");
  return has_offsets == 1;
}

struct GridType {
  bool is_vector, is_half;
};

GridType grid_type(std::string_view type) {
  constexpr std::string_view kHalf = "_HalfFloat";
  const bool is_half = type.ends_with(kHalf);
  const std::string_view tree = type.substr(0, type.size() - (is_half ? kHalf.size() : 0));
  if (tree != "Tree_float_5_4_3" && tree != "Tree_vec3s_5_4_3")
    throw Error("is of type " + printable(type) + "; expected vec3s or float");
  return {tree == "Tree_vec3s_5_4_3", is_half};
}

// A map from indices to the world: the library reads these sizes.
void walk_transform(ByteCursor& in) {
  constexpr std::pair<std::string_view, std::uint64_t> kMaps[] = {{"AffineMap", 128},
                                                                  {"UnitaryMap", 128},
                                                                  {"ScaleMap", 120},
                                                                  {"UniformScaleMap", 120},
                                                                  {"TranslationMap", 24},
                                                                  {"ScaleTranslateMap", 144},
                                                                  {"UniformScaleTranslateMap", 144}};
  const std::string_view name = in.text("the type of a transform", kLongestName);
  for (const auto& [known, bytes] : kMaps)
    if (name == known) {
      in.take(bytes, "a transform");
      return;
    }
  throw Error("has a transform of type " + quoted(name) + "; allowed: linear ones");
}

class GridWalk {
 public:
  GridWalk(ByteCursor& in, MemoryClaim& memory, bool has_offsets)
      : in_(in), memory_(memory), has_offsets_(has_offsets) {}

  void walk() {
    const std::string_view name = in_.text("the name of a grid", kLongestName);
    try {
      walk_descriptor();
      walk_data();
    } catch (const std::exception& error) {
      throw Error("grid " + quoted(name) + ": " + error.what());
    }
  }

 private:
  void walk_descriptor() {
    type_ = grid_type(in_.text("the type of a grid", kLongestName));
    if (!in_.text("the name of another grid", kLongestName).empty())
      throw Error("shares the values of another grid; write it with values of its own");
    for (std::int64_t& offset : offsets_) offset = in_.number<std::int64_t>("the offsets of a grid");
  }

  void walk_data() {
    require_here(0, "grid");
    const auto compression = in_.number<std::uint32_t>("the compression of a grid");
    if (compression & ~(kVdbZip | kVdbActiveMask | kVdbBlosc))
      throw Error("has the compression " + std::to_string(compression) + "; allowed: 0 to 7");
    const VdbMetadata metadata = check_vdb_metadata(in_);
    memory_.add(metadata.bytes_in_memory);
    if (metadata.is_saved_as_half != type_.is_half)
      throw Error("its type and its metadata do not agree on whether values are halves");
    walk_transform(in_);
    const std::uint64_t numbers = type_.is_vector ? 3 : 1;
    VdbTreeWalk tree(in_, memory_, {4 * numbers, (type_.is_half ? 2 : 4) * numbers, compression});
    tree.walk_nodes();
    require_here(1, "values");
    tree.walk_leaf_values();
    require_here(2, "end");
  }

  void require_here(std::size_t which, const char* what) const {
    if (has_offsets_ && offsets_[which] != static_cast<std::int64_t>(in_.position()))
      throw Error("states its " + std::string(what) + " at byte " + std::to_string(offsets_[which]) +
                  "; found at " + std::to_string(in_.position()));
  }

  ByteCursor& in_;
  MemoryClaim& memory_;
  bool has_offsets_;
  GridType type_{};
  std::int64_t offsets_[3] = {};
};

}  // namespace

bool is_vdb(std::string_view bytes) {
  return bytes.starts_with(kMagic) && bytes.size() >= kVdbUuidOffset + kVdbUuidSize;
}

void check_vdb_structure(std::string_view bytes, const std::string& marker) {
  ByteCursor in(bytes);
  MemoryClaim memory("reading the grids", bytes.size());
  const bool has_offsets = walk_header(in);
  const VdbMetadata metadata = check_vdb_metadata(in);
  if (!metadata.names.count(marker)) throw Error("it is an OpenVDB file, but not a Sunbeam table");
  memory.add(metadata.bytes_in_memory);
  const auto grids = in.number<std::int32_t>("the number of grids");
  if (grids < 0 || grids > kMostGrids)
    throw Error("the number of grids is " + std::to_string(grids) + "; allowed: 0 to " +
                std::to_string(kMostGrids));
  for (std::int32_t k = 0; k < grids; ++k) GridWalk(in, memory, has_offsets).walk();
  if (in.left() > 0) throw Error(std::to_string(in.left()) + " bytes follow the last grid");
}

}  // namespace v1
}  // namespace sunbeam
