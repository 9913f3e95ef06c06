// This file bounds the memory that a file may ask for. A small file can claim a huge array or unpack to a
// thousand times its size, so readers ask before they allocate.
#pragma once

#include <cstdint>
#include <string>

#include "sunbeam/core/export.h"

namespace sunbeam {
inline namespace v1 {

// Returns the most bytes of memory that the contents of a file of `file_bytes` may take: 1 GB (1e9) plus four
// times the file's size, or what set_read_limit() allows if that is more.
std::uint64_t read_limit(std::uint64_t file_bytes);

// Raises the limit of this process for files whose headers are trusted. It may be called at any time, from
// any thread.
SUNBEAM_EXPORT void set_read_limit(std::uint64_t bytes);

// Throws Error if `bytes` of memory are more than read_limit(file_bytes). The message starts with `what`,
// which names what asks for it: "image 'a.exr' of 20000 x 40000 pixels".
SUNBEAM_EXPORT void require_within_read_limit(const std::string& what, std::uint64_t bytes,
                                              std::uint64_t file_bytes);

}  // namespace v1
}  // namespace sunbeam
