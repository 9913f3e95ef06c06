#include "runtime/src/vdb/vdb_blocks.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr const char* kBlock = "a block of values";

std::string sizes(std::int64_t found, std::uint64_t expected) {
  return std::to_string(found) + " bytes; expected " + std::to_string(expected);
}

}  // namespace

// A size of 0 or less says that the bytes are not packed.
std::string_view check_vdb_block(ByteCursor& in, std::uint32_t compression, std::uint64_t bytes) {
  if (!(compression & (kVdbZip | kVdbBlosc))) {
    in.take(bytes, kBlock);
    return {};
  }
  const auto size = in.number<std::int64_t>(kBlock);
  if (size <= 0) {
    if (size != -static_cast<std::int64_t>(bytes))
      throw Error("a block of values before byte " + std::to_string(in.position()) + " has the size " +
                  std::to_string(size) + "; expected -" + std::to_string(bytes) + ", or packed bytes");
    in.take(bytes, kBlock);
    return {};
  }
  const std::string_view packed = in.take(static_cast<std::uint64_t>(size), kBlock);
  if (compression & kVdbBlosc) check_blosc_block(packed, bytes);
  return packed;
}

// Of the header's 16 bytes, [0] is the version, [2] has the flags, [3] is the size of a value, and three
// 32-bit numbers follow. Flags: 4 shuffles bits, 8 is free, and the uppermost three name the packer.
void check_blosc_block(std::string_view block, std::uint64_t bytes) {
  constexpr unsigned kVersion = 2, kBitShuffle = 4, kFree = 8, kLz4 = 1;
  ByteCursor header(block);
  const auto version = header.number<std::uint8_t>(kBlock);
  header.number<std::uint8_t>(kBlock);
  const auto flags = header.number<std::uint8_t>(kBlock);
  const auto value_bytes = header.number<std::uint8_t>(kBlock);
  const auto unpacked = header.number<std::uint32_t>(kBlock);
  const auto part = header.number<std::uint32_t>(kBlock);
  const auto packed = header.number<std::uint32_t>(kBlock);
  if (version != kVersion || (flags & (kBitShuffle | kFree)) || flags >> 5 != kLz4 || value_bytes == 0)
    throw Error("a block of values is packed by Blosc in another way than OpenVDB does it");
  if (packed != block.size()) throw Error("a Blosc block says that it has " + sizes(packed, block.size()));
  if (unpacked != bytes) throw Error("a Blosc block says that it unpacks to " + sizes(unpacked, bytes));
  if (unpacked > 0 && (part == 0 || part > unpacked))
    throw Error("a Blosc block has parts of " + std::to_string(part) + " bytes; allowed: 1 to " +
                std::to_string(unpacked));
}

}  // namespace v1
}  // namespace sunbeam
