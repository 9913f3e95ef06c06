#include "runtime/src/vdb/vdb_tree.h"

#include <bit>

#include "runtime/src/vdb/vdb_blocks.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::uint64_t kLeafValues = 512, kLeafMaskBytes = kLeafValues / 8;
constexpr std::int32_t kRootStep = 4096, kRootEnd = 1 << 30;
constexpr std::array<std::int32_t, 3> kBeforeAll = {-1, 0, 0};

std::uint64_t bits_in(std::string_view mask) {
  std::uint64_t count = 0;
  for (std::size_t at = 0; at < mask.size(); at += 8) {
    std::uint64_t word;
    std::memcpy(&word, mask.data() + at, sizeof word);
    count += static_cast<std::uint64_t>(std::popcount(word));
  }
  return count;
}

bool share_a_bit(std::string_view a, std::string_view b) {
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k] & b[k]) return true;
  return false;
}

}  // namespace

void VdbTreeWalk::walk_nodes() {
  const auto buffers = in_.number<std::int32_t>("the head of a tree");
  if (buffers != 1)
    throw Error("a tree has " + std::to_string(buffers) + " buffers for each leaf node; allowed: 1");
  in_.take(values_.bytes, "the background of a tree");
  const auto tiles = in_.number<std::uint32_t>("the head of a tree");
  const auto children = in_.number<std::uint32_t>("the head of a tree");
  walk_root_tiles(tiles);
  walk_root_children(children);
}

// Children are read in the order of the file and their leaf nodes in that of their places, hence one order.
VdbTreeWalk::Place VdbTreeWalk::next_place(const Place& last) {
  Place place;
  for (std::int32_t& x : place) {
    x = in_.number<std::int32_t>("the place of a root's entry");
    if (x < 0 || x >= kRootEnd || x % kRootStep != 0)
      throw Error("an entry of a root is at " + std::to_string(x) + "; allowed: multiples of " +
                  std::to_string(kRootStep) + " from 0 to below " + std::to_string(kRootEnd));
  }
  if (place <= last) throw Error("the entries of a root are not in ascending order");
  return place;
}

void VdbTreeWalk::walk_root_tiles(std::uint32_t count) {
  constexpr std::uint64_t kTileMemory = 100;
  Place last = kBeforeAll;
  for (std::uint32_t k = 0; k < count; ++k) {
    last = next_place(last);
    in_.take(values_.bytes, "the value of a root's tile");
    if (in_.number<std::uint8_t>("the state of a root's tile") > 1)
      throw Error("a tile of a root is neither active nor inactive");
    memory_.add(kTileMemory);
  }
}

void VdbTreeWalk::walk_root_children(std::uint32_t count) {
  Place last = kBeforeAll;
  for (std::uint32_t k = 0; k < count; ++k) {
    last = next_place(last);
    const std::uint64_t lower_nodes = walk_inner_node(32 * 32 * 32);
    for (std::uint64_t j = 0; j < lower_nodes; ++j) walk_lower_node();
  }
}

void VdbTreeWalk::walk_lower_node() {
  const std::uint64_t leaves = walk_inner_node(16 * 16 * 16);
  in_.take(leaves * kLeafMaskBytes, "the value masks of leaf nodes");
  leaves_ += leaves;
  memory_.add(leaves * (kLeafValues * values_.bytes + 2 * kLeafMaskBytes));
}

// Returns the number of children. A place holds a child's address or a value, and the library leaves a node
// half made where its values do not unpack, so that they are unpacked here first.
std::uint64_t VdbTreeWalk::walk_inner_node(std::uint64_t places) {
  const std::string_view children = in_.take(places / 8, "the child mask of an inner node");
  const std::string_view actives = in_.take(places / 8, "the value mask of an inner node");
  if (share_a_bit(children, actives))
    throw Error("an inner node has a child and an active value in one place");
  const std::uint64_t place_bytes = (values_.bytes + 7) / 8 * 8;
  memory_.add(places * place_bytes + 2 * places / 8);
  const Block block = walk_values(places, bits_in(actives));
  if (!block.packed.empty()) require_unpacks(block.packed, values_.compression, block.bytes);
  return bits_in(children);
}

void VdbTreeWalk::walk_leaf_values() {
  for (std::uint64_t k = 0; k < leaves_; ++k)
    walk_values(kLeafValues, bits_in(in_.take(kLeafMaskBytes, "the value mask of a leaf node")));
}

// The first byte says which of the values that are not active stand in the file, and whether a mask chooses
// between two of them.
VdbTreeWalk::Block VdbTreeWalk::walk_values(std::uint64_t count, std::uint64_t active_count) {
  constexpr std::uint8_t kAll = 6;
  const auto inactive = in_.number<std::uint8_t>("the kind of a node's values");
  if (inactive > kAll)
    throw Error("the values of a node are of the kind " + std::to_string(inactive) + "; allowed: 0 to 6");
  const bool has_first = inactive == 2 || inactive == 4 || inactive == 5, has_second = inactive == 5;
  in_.take((has_first + has_second) * values_.bytes, "the inactive values of a node");
  const bool has_mask = inactive == 3 || inactive == 4 || inactive == 5;
  in_.take(has_mask ? count / 8 : 0, "the inactive values of a node");
  const bool only_actives = (values_.compression & kVdbActiveMask) && inactive != kAll;
  const std::uint64_t bytes = values_.stored_bytes * (only_actives ? active_count : count);
  const bool has_block = bytes > 0 || values_.stored_bytes == values_.bytes;  // no empty block of halves
  return {has_block ? check_vdb_block(in_, values_.compression, bytes) : std::string_view(), bytes};
}

}  // namespace v1
}  // namespace sunbeam
