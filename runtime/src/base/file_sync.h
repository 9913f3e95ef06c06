// This file does what standard C++ cannot do to a file.
#pragma once

#include <string>

namespace sunbeam {
inline namespace v1 {

// Returns when the closed file at `path` is on the disk: true, or false with errno if it cannot be. With
// SUNBEAM_PORTABLE the system writes it when it likes.
bool sync_to_disk(const std::string& path);

}  // namespace v1
}  // namespace sunbeam
