// This file writes to what cannot be replaced, and says why something cannot be written.
#pragma once

#include <string>
#include <string_view>

#include "sunbeam/detail/file.h"

namespace sunbeam {
inline namespace v1 {

// Writes to a stream, which stays what it is. Throws Error naming `name`.
void write_to_stream(const std::string& path, std::string_view bytes, const std::string& name);

// Throws Error: "PATH: cannot write: REASON", the reason being that of `error`, a value of errno or 0.
[[noreturn]] void fail_to_write(const std::string& path, int error);

}  // namespace v1
}  // namespace sunbeam
