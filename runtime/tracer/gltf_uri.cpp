#include "runtime/tracer/gltf_uri.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <filesystem>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kData = "data:";

// The value of each digit of base64, -1 of all else.
constexpr std::array<int, 256> base64_digits() {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> values = {};
  values.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    values[static_cast<unsigned char>(kDigits[i])] = static_cast<int>(i);
  return values;
}

std::string from_base64(std::string_view text) {
  static constexpr std::array<int, 256> kValues = base64_digits();
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = kValues[static_cast<unsigned char>(c)];
    if (digit < 0) throw Error("a buffer's base64 text has a wrong letter");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
  }
  return bytes;
}

// A % that no two hexadecimal digits follow stands for itself.
std::string percent_decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      result += static_cast<char>(byte);
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

fs::path resolved(const fs::path& path) {
  std::error_code error;
  const fs::path result = fs::weakly_canonical(path, error);
  if (error) throw Error(fmt::format("{}: cannot read: {}", path.string(), error.message()));
  return result;
}

bool is_inside(const fs::path& path, const std::string& folder) {
  const fs::path outer = resolved(folder.empty() ? "." : folder);
  return std::mismatch(outer.begin(), outer.end(), path.begin(), path.end()).first == outer.end();
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with(kData); }

std::string read_data_uri(std::string_view uri) {
  const auto comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64"))
    throw Error("a data URI is not base64");
  return from_base64(uri.substr(comma + 1));
}

std::string resolve_uri(std::string_view uri, const std::vector<std::string>& folders) {
  const std::string name = percent_decoded(uri);
  const fs::path named = fs::path(folders.at(0)) / name;
  if (name.empty() || name.find('\0') != std::string::npos || fs::path(name).is_absolute())
    throw Error(
        fmt::format("the uri '{}' is not read; allowed: a path from the folder of the file", excerpt(uri)));
  const fs::path path = resolved(named);
  if (std::none_of(folders.begin(), folders.end(),
                   [&](const std::string& folder) { return is_inside(path, folder); }))
    throw Error(
        fmt::format("the uri '{}' leads out of the folders of the file and of the scene", excerpt(uri)));
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
    throw Error(fmt::format("{}: cannot read: it is no regular file", printable(named.string())));
  return path.string();
}

}  // namespace sunbeam
