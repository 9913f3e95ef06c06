// This file checks the blocks of values in an OpenVDB file, each a size and that many bytes, packed or not.
#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/src/vdb/byte_cursor.h"

namespace sunbeam {
inline namespace v1 {

// The bits by which a grid says how its blocks are packed.
constexpr std::uint32_t kVdbZip = 1, kVdbActiveMask = 2, kVdbBlosc = 4;

// Takes a block from the cursor. Throws Error unless it has, or may unpack to, `bytes` bytes. Returns the
// packed bytes, none if it is not packed.
std::string_view check_vdb_block(ByteCursor& in, std::uint32_t compression, std::uint64_t bytes);

// Throws Error unless the header of a Blosc block states its own size and `bytes` for what it unpacks to. The
// library that unpacks it trusts the first of the two.
void check_blosc_block(std::string_view block, std::uint64_t bytes);

// Throws Error unless the packed bytes unpack to `bytes` bytes, which is found out by unpacking them.
void require_unpacks(std::string_view packed, std::uint32_t compression, std::uint64_t bytes);

}  // namespace v1
}  // namespace sunbeam
