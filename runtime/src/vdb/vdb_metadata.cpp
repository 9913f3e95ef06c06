#include "runtime/src/vdb/vdb_metadata.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "runtime/src/vdb/vdb_blocks.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::uint32_t kMostEntries = 10000, kLongestName = 1000;
constexpr std::uint64_t kLongestText = 16000000;  // of all texts of a list

// The library reads these sizes whatever the file states.
constexpr std::pair<std::string_view, std::uint32_t> kSizes[] = {
    {"bool", 1},   {"int32", 4},  {"int64", 8},  {"float", 4},   {"double", 8}, {"vec2i", 8},
    {"vec2s", 8},  {"vec2d", 16}, {"vec3i", 12}, {"vec3s", 12},  {"vec3d", 24}, {"vec4i", 16},
    {"vec4s", 16}, {"vec4d", 32}, {"mat4s", 64}, {"mat4d", 128},
};

// One of the two lists of "delayed load", plain or packed. The library pads short ones before it packs them.
void check_leaf_list(ByteCursor& in, std::uint32_t packed, std::uint64_t bytes) {
  constexpr std::uint64_t kPadded = 128;
  if (packed > 0)
    check_blosc_block(in.take(packed, "a list of leaf nodes"), std::max(bytes, kPadded));
  else
    in.take(bytes, "a list of leaf nodes");
}

// What the library writes to find leaf nodes later on. It keeps three copies while it reads. Returns the
// bytes of memory that they take.
std::uint64_t check_delayed_load(std::string_view value) {
  if (value.empty()) return 0;
  constexpr std::uint32_t kNoSizes = 0xffffffff;
  ByteCursor in(value);
  const std::uint64_t leaves = in.number<std::uint32_t>("a list of leaf nodes");
  check_leaf_list(in, in.number<std::uint32_t>("a list of leaf nodes"), leaves);
  const auto packed = in.number<std::uint32_t>("a list of leaf nodes");
  if (packed != kNoSizes) check_leaf_list(in, packed, 8 * leaves);
  if (in.left() > 0)
    throw Error("a list of leaf nodes is followed by " + std::to_string(in.left()) + " bytes");
  return 3 * (1 + 8) * leaves;
}

bool truth_of(std::string_view value) {
  if (value[0] != 0 && value[0] != 1)
    throw Error("it is " + std::to_string(static_cast<unsigned char>(value[0])) + "; allowed: 0 and 1");
  return value[0] == 1;
}

void require_size(std::string_view type, std::size_t size) {
  const auto* known = std::find_if(std::begin(kSizes), std::end(kSizes),
                                   [&](const auto& entry) { return entry.first == type; });
  if (known == std::end(kSizes))
    throw Error("its type '" + printable(type) + "' is not one that OpenVDB itself has");
  if (size != known->second)
    throw Error("its type " + std::string(type) + " takes " + std::to_string(known->second) +
                " bytes; found " + std::to_string(size));
}

class MetadataWalk {
 public:
  explicit MetadataWalk(ByteCursor& in) : in_(in) {}

  VdbMetadata walk() {
    const auto count = in_.number<std::uint32_t>("a list of metadata");
    if (count > kMostEntries)
      throw Error("a list of metadata has " + std::to_string(count) + " entries; allowed: up to " +
                  std::to_string(kMostEntries));
    for (std::uint32_t k = 0; k < count; ++k) walk_entry();
    return std::move(found_);
  }

 private:
  void walk_entry() {
    const std::string name(in_.text("the name of a metadata entry", kLongestName));
    const std::string_view type = in_.text("the type of a metadata entry", kLongestName);
    const auto size = in_.number<std::uint32_t>("the size of a metadata entry");
    const std::string_view value = in_.take(size, "the value of a metadata entry");
    try {
      if (!found_.names.insert(name).second) throw Error("the name is there twice");
      check_value(name, type, value);
    } catch (const Error& error) {
      throw Error("metadata '" + printable(name) + "': " + error.what());
    }
  }

  void check_value(const std::string& name, std::string_view type, std::string_view value) {
    const bool says_half = name == "is_saved_as_half_float";
    if (says_half && type != "bool") throw Error("its type is '" + printable(type) + "'; expected bool");
    if (type == "string") {
      text_bytes_ += value.size();
      if (text_bytes_ > kLongestText)
        throw Error("the texts are longer than " + std::to_string(kLongestText) + " bytes");
    } else if (type == "__delayedload") {
      found_.bytes_in_memory += check_delayed_load(value);
    } else {
      require_size(type, value.size());
      if (type != "bool") return;
      const bool is_true = truth_of(value);
      if (says_half) found_.is_saved_as_half = is_true;
    }
  }

  ByteCursor& in_;
  VdbMetadata found_;
  std::uint64_t text_bytes_ = 0;
};

}  // namespace

VdbMetadata check_vdb_metadata(ByteCursor& in) { return MetadataWalk(in).walk(); }

}  // namespace v1
}  // namespace sunbeam
