#include "bake/report/markup.h"

#include <cstdint>

#include "runtime/tracer/image_io.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {

namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";

// Plain text stays; anything else is taken byte by byte, and what is no printable ASCII goes.
std::string plain(std::string_view text) {
  if (is_plain_text(text)) return std::string(text);
  std::string result;
  for (const char c : text)
    if (is_plain_text({&c, 1}))
      result += c;
    else
      result += kReplacement;
  return result;
}

}  // namespace

std::string escape_markup(std::string_view text) {
  std::string result;
  for (const char c : plain(text)) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else if (c == '\'')
      result += "&#39;";
    else
      result += c;
  }
  return result;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t held = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (j < held ? static_cast<unsigned char>(bytes[k + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j) result += j <= held ? kDigits[bits >> (18 - 6 * j) & 63] : '=';
  }
  return result;
}

std::string png_data_uri(const Image& image) {
  ClipAccount ignored;
  return "data:image/png;base64," + base64(png_bytes(image, ignored));
}

}  // namespace sunbeam
