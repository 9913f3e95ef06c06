#include "runtime/src/files/temporary_file.h"

#ifndef SUNBEAM_PORTABLE
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string_view>
#include <system_error>

#include "runtime/src/files/output_target.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
inline namespace v1 {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".sunbeam-tmp";
constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz234567";
constexpr std::size_t kRandomLetters = 12;

std::string random_letters() {
  std::random_device random;
  std::string letters;
  while (letters.size() < kRandomLetters) letters += kLetters[random() % kLetters.size()];
  return letters;
}

// The start of the names of all temporaries of a target. Long names are cut between two characters of UTF-8.
std::string prefix_of(const fs::path& target) {
  constexpr std::size_t kLongest = 143;  // bytes of a name on the narrowest file system, eCryptfs
  const std::string name = target.filename().string();
  std::size_t size = std::min(name.size(), kLongest - 2 - kRandomLetters - kSuffix.size());
  while (size < name.size() && size > 0 && (static_cast<unsigned char>(name[size]) & 0xc0) == 0x80) --size;
  return "." + name.substr(0, size) + ".";
}

// The files that are being written, for a signal handler. A path is taken out before it is freed.
std::array<std::atomic<const std::string*>, 64> live_paths;

void enter(const std::string* path) {
  for (auto& place : live_paths)
    if (const std::string* none = nullptr; place.compare_exchange_strong(none, path)) return;
}

// False if a signal handler has taken the path.
bool leave(const std::string* path) {
  for (auto& place : live_paths)
    if (const std::string* here = path; place.compare_exchange_strong(here, nullptr)) return true;
  return false;
}

#ifdef SUNBEAM_PORTABLE

void remove_leftovers(const fs::path&) {}

// The descriptor of a new file; -2 if there is a file of this name.
int create(const std::string& path, bool) {
  if (fs::exists(path)) return -2;
  std::FILE* file = std::fopen(path.c_str(), "wbx");
  if (file) std::fclose(file);
  return file ? 0 : -1;
}

bool sync_to_disk(int) { return true; }
void close_file(int) {}

#else

bool is_leftover(const std::string& name, const std::string& prefix) {
  return name.size() == prefix.size() + kRandomLetters + kSuffix.size() && name.starts_with(prefix) &&
         name.ends_with(kSuffix) &&
         name.find_first_not_of(kLetters, prefix.size()) == prefix.size() + kRandomLetters;
}

// A file that nobody has locked is in nobody's use.
void remove_if_unused(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
      ::flock(descriptor, LOCK_EX | LOCK_NB) == 0)
    ::unlink(path.c_str());
  ::close(descriptor);
}

void remove_leftovers(const fs::path& target) {
  const std::string prefix = prefix_of(target);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; entry != end; entry.increment(ignored))
    if (is_leftover(entry->path().filename().string(), prefix)) remove_if_unused(entry->path().string());
}

// The descriptor of a new, locked file. -1 with errno if that cannot be done, -2 if there is a file of this
// name, or if another program took the file for a leftover before it was locked.
int create(const std::string& path, bool is_private) {
  const int descriptor =
      ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, is_private ? 0600 : 0666);
  if (descriptor < 0) return errno == EEXIST ? -2 : -1;
  // Some network file systems know no locks: then nobody removes leftovers.
  const bool is_taken = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  struct stat status {};
  if (!is_taken && ::fstat(descriptor, &status) == 0 && status.st_nlink > 0) return descriptor;
  ::close(descriptor);
  return -2;
}

bool sync_to_disk(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL;  // EINVAL: a device that cannot sync
}

void close_file(int descriptor) { ::close(descriptor); }

#endif

}  // namespace

TemporaryFile::TemporaryFile(const std::string& target) : target_(target) {
  remove_leftovers(target);
  std::error_code ignored;
  const bool is_private = fs::exists(target, ignored);  // until it has the permissions of the old file
  constexpr int kMostTries = 100;
  descriptor_ = -2;
  for (int k = 0; k < kMostTries && descriptor_ == -2; ++k) {
    const std::string name = prefix_of(target) + random_letters() + std::string(kSuffix);
    path_ = std::make_unique<const std::string>((fs::path(target).parent_path() / name).string());
    errno = 0;
    descriptor_ = create(*path_, is_private);
  }
  if (descriptor_ < 0) fail_to_write(target, errno);
  enter(path_.get());
}

TemporaryFile::~TemporaryFile() {
  std::remove(path_->c_str());  // does nothing after the file was renamed
  close_file(descriptor_);
  if (!leave(path_.get())) path_.release();  // the handler may be reading it, and the program ends
}

bool TemporaryFile::replace_target() {
  if (!copy_access(*path_, target_) || !sync_to_disk(descriptor_)) return false;
  std::error_code error;
  fs::rename(*path_, target_, error);
  errno = error.value();
  return !error;
}

#ifdef SUNBEAM_PORTABLE

bool copy_access(const std::string& path, const std::string& like) {
  std::error_code error;
  const fs::file_status status = fs::status(like, error);
  if (!fs::is_regular_file(status)) return true;
  fs::permissions(path, status.permissions() & fs::perms::all, error);
  return !error;
}

#else

bool copy_access(const std::string& path, const std::string& like) {
  struct stat old {};
  struct stat made {};
  if (::stat(like.c_str(), &old) != 0 || !S_ISREG(old.st_mode)) return true;
  if (::stat(path.c_str(), &made) != 0) return false;
  constexpr auto kSame = static_cast<uid_t>(-1);
  [[maybe_unused]] const bool has_owner =
      made.st_uid == old.st_uid || ::chown(path.c_str(), old.st_uid, kSame) == 0;
  const bool has_group = made.st_gid == old.st_gid || ::chown(path.c_str(), kSame, old.st_gid) == 0;
  const mode_t mode = old.st_mode & (has_group ? 0777 : 0707);
  // Some file systems have no modes to change.
  return ::chmod(path.c_str(), mode) == 0 || (made.st_mode & 0777 & ~mode) == 0;
}

#endif

void remove_temporaries() {
  for (auto& place : live_paths)
    if (const std::string* path = place.exchange(nullptr)) std::remove(path->c_str());
}

}  // namespace v1
}  // namespace sunbeam
