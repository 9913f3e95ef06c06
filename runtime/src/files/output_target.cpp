#include "runtime/src/files/output_target.h"

#ifdef SUNBEAM_PORTABLE
#include <fstream>
#else
#include <fcntl.h>
#include <unistd.h>
#endif

#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

namespace fs = std::filesystem;

// Whether a link is one of /proc/self/fd, which lead to open files and not to names.
bool is_descriptor(const fs::path& link) {
  std::error_code error;
  const fs::path folder = fs::canonical(link.parent_path(), error);
  if (error) return false;
  const fs::path descriptors = fs::canonical("/proc/self/fd", error);
  return !error && folder == descriptors;
}

// The end of a chain of links, which need not exist; or the first that is a descriptor.
fs::path follow_links(const std::string& path) {
  constexpr int kMostLinks = 40;  // as Linux allows
  fs::path target = path;
  std::error_code error;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, error)); ++links) {
    if (is_descriptor(target)) break;
    if (links == kMostLinks) fail_to_write(path, ELOOP);
    const fs::path next = fs::read_symlink(target, error);
    if (error) fail_to_write(path, error.value());
    target = target.parent_path() / next;
  }
  return target;
}

#ifdef SUNBEAM_PORTABLE

bool may_write(const std::string&) { return true; }

#else

bool may_write(const std::string& path) {
  return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0 || errno == ENOENT || errno == ENOTDIR;
}

// Opening a descriptor's name anew would write at the start of a file, and cannot be done to a socket.
int open_stream(const fs::path& path) {
  if (!is_descriptor(path)) return ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  std::uint64_t descriptor = 0;
  const bool is_number = parse_whole_number(path.filename().string(), descriptor);
  return ::fcntl(is_number && descriptor <= INT_MAX ? static_cast<int>(descriptor) : -1, F_DUPFD_CLOEXEC, 0);
}

#endif

}  // namespace

void fail_to_write(const std::string& path, int error) {
  const std::string name = path.empty() ? "''" : path;
  throw Error(name + ": cannot write: " + (error != 0 ? std::strerror(error) : "writing failed"));
}

OutputTarget output_target(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) fail_to_write(path, error.value());
  if (path.empty()) fail_to_write(path, ENOENT);
  if (fs::is_directory(status) || !fs::path(path).has_filename())
    throw Error(path + ": cannot write: it is a folder");
  const fs::path target = follow_links(path);
  if (is_descriptor(target)) {
    if (!fs::exists(status)) fail_to_write(path, ENOENT);
    return {target.string(), true};
  }
  if (!may_write(target.string())) fail_to_write(path, errno);
  return {target.string(), fs::exists(status) && !fs::is_regular_file(status)};
}

#ifdef SUNBEAM_PORTABLE

void write_to_stream(const std::string& path, std::string_view bytes, const std::string& name) {
  errno = 0;
  std::ofstream stream(path, std::ios::binary | std::ios::app);
  if (!stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush())
    fail_to_write(name, errno);
}

#else

void write_to_stream(const std::string& path, std::string_view bytes, const std::string& name) {
  const int descriptor = open_stream(path);
  if (descriptor < 0) fail_to_write(name, errno);
  int error = 0;
  while (!bytes.empty() && error == 0) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count >= 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR) error = errno;
  }
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error != 0) fail_to_write(name, error);
}

#endif

}  // namespace v1
}  // namespace sunbeam
