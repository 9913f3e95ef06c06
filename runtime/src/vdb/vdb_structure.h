// This file checks the bytes of an OpenVDB file before the library parses them. The library takes sizes and
// counts as the file states them, and writes beyond its arrays where they are wrong.
#pragma once

#include <string>
#include <string_view>

namespace sunbeam {
inline namespace v1 {

constexpr std::size_t kVdbUuidOffset = 21, kVdbUuidSize = 36;

// Returns whether the bytes begin as an OpenVDB file does and are long enough for a UUID.
bool is_vdb(std::string_view bytes);

// Throws Error unless these bytes are an OpenVDB file of grids of floats or of three floats that the library
// reads soundly, and within read_limit(). `marker` is a name that the file's metadata must have.
void check_vdb_structure(std::string_view bytes, const std::string& marker);

}  // namespace v1
}  // namespace sunbeam
