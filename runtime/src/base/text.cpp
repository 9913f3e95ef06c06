#include "sunbeam/detail/text.h"

#include <charconv>
#include <system_error>

namespace sunbeam {
inline namespace v1 {

namespace {

void append_hexadecimal(unsigned char byte, std::string& text) {
  constexpr const char* kDigits = "0123456789abcdef";
  text += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

// How many bytes the character at the front of `text` has; 0 if it is no character of UTF-8. Overlong forms,
// surrogates and what lies beyond U+10FFFF are none.
std::size_t bytes_of_character(std::string_view text) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  for (std::size_t k = 1; k < count; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  const unsigned second = byte(1);
  const bool is_sound = first < 0xe0    ? first >= 0xc2
                        : first == 0xe0 ? second >= 0xa0
                        : first == 0xed ? second < 0xa0
                        : first < 0xf0  ? true
                        : first == 0xf0 ? second >= 0x90
                                        : first < 0xf4 || (first == 0xf4 && second < 0x90);
  return is_sound ? count : 0;
}

// Tells numbers that are too small for a double from those that are too large.
bool is_tiny(std::string_view number) {
  const auto exponent = number.find_first_of("eE");
  if (exponent != std::string_view::npos) return number.substr(exponent + 1).starts_with('-');
  if (number.starts_with('-')) number.remove_prefix(1);
  return number.starts_with('0') || number.starts_with('.');
}

}  // namespace

std::string to_text(double value) {
  char buffer[64];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, result.ptr};
}

std::string to_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += ' ';
    text += to_text(value);
  }
  return text;
}

bool parse_number(std::string_view text, double& value) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ptr != text.data() + text.size()) return false;
  if (result.ec == std::errc::result_out_of_range && is_tiny(text)) {
    value = 0;
    return true;
  }
  return result.ec == std::errc();
}

bool parse_whole_number(std::string_view text, std::uint64_t& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && result.ec == std::errc() && result.ptr == text.data() + text.size();
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (;;) {
    const auto at = text.find(separator);
    parts.emplace_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

std::string shortened(std::string_view text) {
  constexpr std::size_t kMost = 100;
  return std::string(text.substr(0, kMost)) + (text.size() > kMost ? "..." : "");
}

bool is_plain_text(std::string_view text) {
  while (!text.empty()) {
    const std::size_t count = bytes_of_character(text);
    if (count == 0) return false;
    const auto first = static_cast<unsigned char>(text[0]);
    const bool is_break = first == '\n' || first == '\t';
    const bool is_control =
        first < 0x20 || first == 0x7f || (first == 0xc2 && static_cast<unsigned char>(text[1]) < 0xa0);
    if (is_control && !is_break) return false;
    text.remove_prefix(count);
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    const auto next = static_cast<unsigned char>(k + 1 < text.size() ? text[k + 1] : 'a');
    if (byte == '\n') {
      result += "\\n";
    } else if (byte == '\t') {
      result += "\\t";
    } else if (byte < 0x20 || byte == 0x7f) {
      append_hexadecimal(byte, result);
    } else if (byte == 0xc2 && next >= 0x80 && next < 0xa0) {
      append_hexadecimal(byte, result);
      append_hexadecimal(next, result);
      ++k;
    } else {
      result += text[k];
    }
  }
  return result;
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kMost = 60;
  return printable(text.substr(0, kMost)) + (text.size() > kMost ? "..." : "");
}

}  // namespace v1
}  // namespace sunbeam
