#include "sunbeam/detail/file.h"

#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>
#include <sstream>
#include <system_error>
#include <utility>

#include "runtime/src/base/file_sync.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {

AtomicFile::AtomicFile(const std::string& path)
    : target_(path), path_(path + ".tmp" + std::to_string(std::random_device()())) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw Error(path + ": cannot write: it is a folder");
  errno = 0;
  file_.open(path_, std::ios::binary | std::ios::trunc);
  if (!file_) fail();
}

AtomicFile::~AtomicFile() {
  file_.close();
  std::error_code ignored;
  if (!kept_) std::filesystem::remove(path_, ignored);
}

void AtomicFile::write(std::string_view bytes) {
  errno = 0;
  if (!file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail();
  position_ += bytes.size();
}

void AtomicFile::seek(std::uint64_t position) {
  errno = 0;
  if (!file_.seekp(static_cast<std::streamoff>(position))) fail();
  position_ = position;
}

void AtomicFile::keep() {
  errno = 0;
  file_.close();
  if (!file_ || !sync_to_disk(path_)) fail();
  std::error_code error;
  std::filesystem::rename(path_, target_, error);
  if (error) throw Error(target_ + ": cannot write: " + error.message());
  kept_ = true;
}

// Standard C++ need not say why.
void AtomicFile::fail() {
  const std::string reason = errno != 0 ? std::strerror(errno) : "writing failed";
  throw Error(target_ + ": cannot write: " + reason);
}

std::string read_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw Error(path + ": cannot read: it is a folder");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(path + ": cannot read: " + std::strerror(errno));
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (in.bad()) throw Error(path + ": cannot read: " + std::strerror(errno));
  return std::move(bytes).str();
}

std::string read_text(const std::string& path) {
  const std::string bytes = read_file(path);
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    throw Error(path + ": the text is UTF-16; allowed: UTF-8");
  return std::string(without_byte_order_mark(bytes));
}

void write_file_atomically(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.keep();
}

void require_writable(const std::string& path) { AtomicFile probe(path); }

std::string extension(const std::string& path) {
  std::string ext = std::filesystem::path(path).extension().string();
  for (char& c : ext) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ext;
}

}  // namespace v1
}  // namespace sunbeam
