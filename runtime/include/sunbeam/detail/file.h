// This file reads and writes whole files. Writing never leaves a half-written file behind and never harms an
// existing one.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace sunbeam {
inline namespace v1 {

// Writes a file that takes its place only when it is whole. It goes to a temporary beside `path`, which
// keep() flushes to disk and renames; without keep() the temporary is removed. Every function throws Error
// naming `path` (disk full, unwritable), with an older file there untouched.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  std::uint64_t position() const { return position_; }  // of the next write
  void seek(std::uint64_t position);
  void keep();

 private:
  [[noreturn]] void fail();

  std::string target_, path_;
  std::ofstream file_;
  std::uint64_t position_ = 0;
  bool kept_ = false;
};

// Returns the bytes of a file. Throws Error if it cannot be read.
std::string read_file(const std::string& path);

// Returns the same for a text, without the byte order mark of UTF-8. Throws Error for UTF-16 too.
std::string read_text(const std::string& path);

// Writes these bytes by an AtomicFile.
void write_file_atomically(const std::string& path, std::string_view bytes);

// Throws Error unless a file could be created at `path` now. It serves jobs that write only after long work.
void require_writable(const std::string& path);

// Returns the lower-case extension with its dot, "" if there is none.
std::string extension(const std::string& path);

}  // namespace v1
}  // namespace sunbeam
