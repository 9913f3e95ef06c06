// This file checks a list of metadata in an OpenVDB file.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "runtime/src/vdb/byte_cursor.h"

namespace sunbeam {
inline namespace v1 {

struct VdbMetadata {
  std::set<std::string> names;
  bool is_saved_as_half = false;
  std::uint64_t bytes_in_memory = 0;  // of what unpacks
};

// Takes a list from the cursor. Throws Error if the library would read other sizes than the file states, or
// if an entry is of no type that OpenVDB itself has.
VdbMetadata check_vdb_metadata(ByteCursor& in);

}  // namespace v1
}  // namespace sunbeam
