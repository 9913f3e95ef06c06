#include "runtime/src/base/file_sync.h"

#ifndef SUNBEAM_PORTABLE
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#endif

namespace sunbeam {
inline namespace v1 {

#ifdef SUNBEAM_PORTABLE

bool sync_to_disk(const std::string&) { return true; }

#else

bool sync_to_disk(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL;  // EINVAL: a device that cannot sync
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return synced;
}

#endif

}  // namespace v1
}  // namespace sunbeam
