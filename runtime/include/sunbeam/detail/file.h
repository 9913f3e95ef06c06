// This file reads and writes whole files. Writing never leaves a half-written file behind and never harms an
// existing one.
//
// A path to write to is followed through symbolic links, and a link stays one. A file there is replaced, and
// keeps its permissions; its other hard links keep the old contents. A device, a FIFO or /dev/stdout is
// written to.
#pragma once

#include <cstdint>
#include <fstream>
#include <istream>
#include <memory>
#include <string>
#include <string_view>

namespace sunbeam {
inline namespace v1 {

class TemporaryFile;

// Writes a file that takes its place only when it is whole. It goes to a temporary in the folder of the file,
// which keep() flushes to disk and renames; without keep() the temporary is removed. Bytes for a device or a
// FIFO are in memory until keep() writes them. Every function throws Error naming `path` (disk full,
// unwritable), with an older file there untouched.
class AtomicFile {
 public:
  // Removes temporaries that killed programs left behind for the same file.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  std::uint64_t position() const { return position_; }  // of the next write
  void seek(std::uint64_t position);
  void keep();

 private:
  std::string path_, target_;
  std::unique_ptr<TemporaryFile> temporary_;  // none for a device or a FIFO
  std::ofstream file_;                        // closed before its file is removed
  std::string stream_;
  std::uint64_t position_ = 0;
};

// Returns the bytes of a file, a FIFO or a device. Throws Error if it cannot be read, and if a device has no
// end within read_limit(0).
std::string read_file(const std::string& path);

// Returns what is left of a stream, in the same way. `size` is how much that may be, 0 if it is not known.
std::string read_stream(std::istream& in, const std::string& name, std::uint64_t size = 0);

// Returns a text without the byte order mark of UTF-8. Throws Error for UTF-16.
std::string utf8_text(std::string_view bytes, const std::string& name);

// Returns the text of a file, by both.
std::string read_text(const std::string& path);

// Writes these bytes by an AtomicFile.
void write_file_atomically(const std::string& path, std::string_view bytes);

// Moves a whole file to `path`, as if an AtomicFile had written it; for a device or a FIFO it copies. Throws
// Error naming `path`.
void move_into_place(const std::string& from, const std::string& path);

// Throws Error unless a file could be written at `path` now. It serves jobs that write only after long work.
// A device or a FIFO is not opened.
void require_writable(const std::string& path);

struct OutputTarget {
  std::string path;        // with symbolic links followed: a file to replace, or one to make
  bool is_stream = false;  // a device, a FIFO or a descriptor of this process, such as /dev/stdout
};

// Follows symbolic links as the system does; a link that leads nowhere names the file to make. Throws Error
// naming `path` for a folder, and for a file that may not be written. Nothing is opened.
OutputTarget output_target(const std::string& path);

// Removes the temporaries of all files that are being written. A program that is about to end may call it in
// a signal handler.
void remove_temporaries();

// Returns the lower-case extension with its dot, "" if there is none.
std::string extension(const std::string& path);

}  // namespace v1
}  // namespace sunbeam
