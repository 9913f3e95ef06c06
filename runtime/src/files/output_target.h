// This file finds what a path leads to that is to be written.
#pragma once

#include <string>
#include <string_view>

namespace sunbeam {
inline namespace v1 {

struct OutputTarget {
  std::string path;        // with symbolic links followed: a file to replace, or one to make
  bool is_stream = false;  // a device, a FIFO or a descriptor of this process, such as /dev/stdout
};

// Follows symbolic links as the system does; a link that leads nowhere names the file to make. Throws Error
// naming `path` for a folder, and for a file that may not be written. Nothing is opened.
OutputTarget output_target(const std::string& path);

// Writes to a stream, which stays what it is. Throws Error naming the path.
void write_to_stream(const std::string& path, std::string_view bytes);

// Throws Error: "PATH: cannot write: REASON", the reason being that of `error`, a value of errno or 0.
[[noreturn]] void fail_to_write(const std::string& path, int error);

}  // namespace v1
}  // namespace sunbeam
