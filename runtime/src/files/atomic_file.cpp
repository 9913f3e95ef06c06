#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "runtime/src/files/output_target.h"
#include "runtime/src/files/temporary_file.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
inline namespace v1 {

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  const OutputTarget target = output_target(path);
  target_ = target.path;
  if (target.is_stream) return;
  temporary_ = std::make_unique<TemporaryFile>(target_);
  errno = 0;
  file_.open(temporary_->path(), std::ios::binary | std::ios::in | std::ios::out);
  if (!file_) fail_to_write(path_, errno);
}

AtomicFile::~AtomicFile() = default;

void AtomicFile::write(std::string_view bytes) {
  errno = 0;
  if (!temporary_) {
    if (stream_.size() < position_ + bytes.size()) stream_.resize(position_ + bytes.size());
    std::copy(bytes.begin(), bytes.end(), stream_.begin() + static_cast<std::ptrdiff_t>(position_));
  } else if (!file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    fail_to_write(path_, errno);
  }
  position_ += bytes.size();
}

void AtomicFile::seek(std::uint64_t position) {
  errno = 0;
  if (temporary_ && !file_.seekp(static_cast<std::streamoff>(position))) fail_to_write(path_, errno);
  position_ = position;
}

void AtomicFile::keep() {
  if (!temporary_) return write_to_stream(target_, stream_, path_);
  errno = 0;
  file_.close();
  if (!file_ || !temporary_->replace_target()) fail_to_write(path_, errno);
}

void write_file_atomically(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.keep();
}

void move_into_place(const std::string& from, const std::string& path) {
  const OutputTarget target = output_target(path);
  if (target.is_stream) return write_to_stream(target.path, read_file(from), path);
  if (!copy_access(from, target.path)) fail_to_write(path, errno);
  std::error_code error;
  std::filesystem::rename(from, target.path, error);
  if (error == std::errc::cross_device_link) return write_file_atomically(path, read_file(from));
  if (error) fail_to_write(path, error.value());
}

void require_writable(const std::string& path) {
  const OutputTarget target = output_target(path);
  if (!target.is_stream) TemporaryFile probe(target.path);
}

}  // namespace v1
}  // namespace sunbeam
