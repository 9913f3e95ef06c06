// Whole files in and out. Writing never leaves a half-written file behind and never harms an existing one.
#pragma once

#include <string>
#include <string_view>

namespace sunbeam {

// Throws Error if the file cannot be read.
std::string read_file(const std::string& path);

// Writes to a temporary beside `path`, flushes it to disk, then renames. Throws Error (disk full,
// unwritable), with the temporary removed and an older file at `path` untouched.
void write_file_atomically(const std::string& path, std::string_view bytes);

// Throws Error unless a file could be created at `path` now. For jobs that write only after long work.
void require_writable(const std::string& path);

// Lower-case extension with its dot, "" if none.
std::string extension(const std::string& path);

}  // namespace sunbeam
