// This file checks the tree of a grid in an OpenVDB file: a root, two levels of inner nodes of 32^3 and 16^3
// places, and leaf nodes of 8^3 values (OpenVDB's tree type "5_4_3").
#pragma once

#include <array>
#include <cstdint>

#include "runtime/src/vdb/byte_cursor.h"
#include "runtime/src/vdb/memory_claim.h"

namespace sunbeam {
inline namespace v1 {

struct VdbValues {
  std::uint64_t bytes;         // of a value in memory, and of one that stands alone in the file
  std::uint64_t stored_bytes;  // of a value in a block
  std::uint32_t compression;
};

// Takes a tree from the cursor in two steps, as it is stored: its nodes, then the values of its leaf nodes.
// Both throw Error where the library would read something else than the file has, or would not be safe.
class VdbTreeWalk {
 public:
  VdbTreeWalk(ByteCursor& in, MemoryClaim& memory, const VdbValues& values)
      : in_(in), memory_(memory), values_(values) {}

  void walk_nodes();
  void walk_leaf_values();

 private:
  using Place = std::array<std::int32_t, 3>;
  struct Block {
    std::string_view packed;  // empty if it is not packed
    std::uint64_t bytes;      // unpacked
  };

  void walk_root_tiles(std::uint32_t count);
  void walk_root_children(std::uint32_t count);
  Place next_place(const Place& last);
  std::uint64_t walk_inner_node(std::uint64_t places);
  void walk_lower_node();
  Block walk_values(std::uint64_t count, std::uint64_t active_count);

  ByteCursor& in_;
  MemoryClaim& memory_;
  VdbValues values_;
  std::uint64_t leaves_ = 0;
};

}  // namespace v1
}  // namespace sunbeam
