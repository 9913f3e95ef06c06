// Whole files in and out. Writing never leaves a half-written file behind and never harms an existing one.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace sunbeam::inline v1 {

// A file that takes its place only when it is whole: written to a temporary beside `path`, which keep()
// flushes to disk and renames; without it the temporary is removed. Every function throws Error naming `path`
// (disk full, unwritable), with an older file there untouched.
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

// Throws Error if the file cannot be read.
std::string read_file(const std::string& path);

// An AtomicFile of these bytes.
void write_file_atomically(const std::string& path, std::string_view bytes);

// Throws Error unless a file could be created at `path` now. For jobs that write only after long work.
void require_writable(const std::string& path);

// Lower-case extension with its dot, "" if none.
std::string extension(const std::string& path);

}  // namespace sunbeam::inline v1
