#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_read(const std::string& path, const std::string& reason) {
  throw Error((path.empty() ? "''" : path) + ": cannot read: " + reason);
}

// 0 where it is not known before the end: of a FIFO, a device, a file of /proc.
std::uint64_t size_of(const std::string& path) {
  std::error_code error;
  const std::uint64_t size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
  return error ? 0 : size;
}

// Reads up to `most` bytes and reports whether there may be more.
bool read_more(std::istream& in, std::string& bytes, std::uint64_t most) {
  const std::size_t start = bytes.size();
  bytes.resize(start + most);
  in.read(bytes.data() + start, static_cast<std::streamsize>(most));
  bytes.resize(start + static_cast<std::size_t>(in.gcount()));
  return !in.eof() && !in.bad();
}

}  // namespace

std::string read_stream(std::istream& in, const std::string& name, std::uint64_t size) {
  const std::uint64_t limit = read_limit(size);
  constexpr std::uint64_t kLeast = 1 << 16;
  std::string bytes;
  errno = 0;
  for (std::uint64_t chunk = size + 1; read_more(in, bytes, chunk);) {  // the last byte meets the end
    if (bytes.size() > limit) fail_to_read(name, "no end after " + std::to_string(limit / 1000000) + " MB");
    chunk = std::min(std::max<std::uint64_t>(kLeast, bytes.size()), limit + 1 - bytes.size());
  }
  if (in.bad()) fail_to_read(name, std::strerror(errno));
  return bytes;
}

std::string read_file(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) fail_to_read(path, "it is a folder");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) fail_to_read(path, std::strerror(errno));
  return read_stream(in, path, size_of(path));
}

std::string utf8_text(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    throw Error(name + ": the text is UTF-16; allowed: UTF-8");
  return std::string(without_byte_order_mark(bytes));
}

std::string read_text(const std::string& path) { return utf8_text(read_file(path), path); }

std::string extension(const std::string& path) {
  std::string ext = std::filesystem::path(path).extension().string();
  for (char& c : ext) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ext;
}

}  // namespace v1
}  // namespace sunbeam
