#include "runtime/tracer/radiance_hdr.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <vector>

#include "runtime/tracer/chromaticities.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

// Takes lines and bytes from the front.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : bytes_(bytes) {}

  std::string_view line() {
    const std::size_t end = bytes_.find('\n');
    if (end == std::string_view::npos) throw Error("the header has no end");
    std::string_view text = bytes_.substr(0, end);
    bytes_.remove_prefix(end + 1);
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
  }
  std::uint8_t byte() {
    if (bytes_.empty()) throw Error("the file ends early");
    const auto value = static_cast<std::uint8_t>(bytes_.front());
    bytes_.remove_prefix(1);
    return value;
  }
  // Returns a byte further on without taking it; 0 beyond the end.
  std::uint8_t peek(std::size_t k) const {
    return k < bytes_.size() ? static_cast<std::uint8_t>(bytes_[k]) : 0;
  }

 private:
  std::string_view bytes_;
};

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> result;
  for (std::string& word : split(text, ' '))
    if (!word.empty()) result.push_back(std::move(word));
  return result;
}

std::vector<double> numbers(std::string_view key, std::string_view text, std::size_t count) {
  std::vector<double> result;
  for (const std::string& word : words(text)) {
    double value = 0;
    if (parse_number(word, value) && std::isfinite(value)) result.push_back(value);
  }
  if (result.size() != count || words(text).size() != count)
    throw Error(fmt::format("{} is '{}'; allowed: {} numbers", key, printable(text), count));
  return result;
}

// What the lines before the picture say.
struct Header {
  Rgb scale{1};  // pixels were multiplied by it
  bool has_primaries = false;
  Chromaticities primaries;
};

void divide_out(Header& header, std::string_view key, const Rgb& factor) {
  constexpr double kLeast = 1e-30, kMost = 1e30;
  header.scale = header.scale * factor;
  for (int channel = 0; channel < 3; ++channel)
    if (!(header.scale[channel] >= kLeast && header.scale[channel] <= kMost))
      throw Error(fmt::format("{} makes a factor of {:g}; allowed: {:g} to {:g}", key, header.scale[channel],
                              kLeast, kMost));
}

void read_variable(Header& header, std::string_view key, std::string_view value) {
  if (key == "FORMAT") {
    if (words(value) != std::vector<std::string>{"32-bit_rle_rgbe"})
      throw Error(fmt::format("FORMAT is '{}'; allowed: 32-bit_rle_rgbe", printable(value)));
  } else if (key == "EXPOSURE") {
    divide_out(header, key, Rgb(numbers(key, value, 1)[0]));
  } else if (key == "COLORCORR") {
    const auto n = numbers(key, value, 3);
    divide_out(header, key, {n[0], n[1], n[2]});
  } else if (key == "PRIMARIES") {
    const auto n = numbers(key, value, 8);
    header.primaries = {{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}};
    header.has_primaries = true;
  } else if (key == "GAMMA" && numbers(key, value, 1)[0] != 1) {
    throw Error(fmt::format("GAMMA is '{}'; allowed: 1", printable(value)));
  }
}

Header read_header(Cursor& cursor) {
  Header header;
  for (std::string_view line = cursor.line(); !line.empty(); line = cursor.line()) {
    const std::size_t equals = line.find('=');
    if (line.front() != '#' && equals != std::string_view::npos)
      read_variable(header, line.substr(0, equals), line.substr(equals + 1));
  }
  return header;
}

// How scan lines lie in the picture: "-Y 512 +X 1024" has rows from the top, and pixels from the left.
struct Layout {
  bool is_by_rows = true;
  bool from_right = false, from_bottom = false;
  int width = 0, height = 0;

  int lines() const { return is_by_rows ? height : width; }
  int length() const { return is_by_rows ? width : height; }
  void set(Image& image, int line, int k, const Rgb& value) const {
    const int x = is_by_rows ? k : line, y = is_by_rows ? line : k;
    image.set(from_right ? width - 1 - x : x, from_bottom ? height - 1 - y : y, value);
  }
};

Layout read_layout(std::string_view line) {
  const std::vector<std::string> parts = words(line);
  Layout layout;
  const auto read_axis = [&](const std::string& axis, const std::string& size) {
    const bool is_x = axis == "-X" || axis == "+X", is_y = axis == "-Y" || axis == "+Y";
    int& to = is_x ? layout.width : layout.height;
    const auto [end, error] = std::from_chars(size.data(), size.data() + size.size(), to);
    if (is_x) layout.from_right = axis[0] == '-';
    if (is_y) layout.from_bottom = axis[0] == '+';
    return (is_x || is_y) && error == std::errc() && end == size.data() + size.size() && to > 0;
  };
  const bool is_good = parts.size() == 4 && read_axis(parts[0], parts[1]) && read_axis(parts[2], parts[3]) &&
                       layout.width > 0 && layout.height > 0;
  if (!is_good) throw Error(fmt::format("the size is '{}'; allowed: as -Y HEIGHT +X WIDTH", printable(line)));
  layout.is_by_rows = parts[0].ends_with('Y');
  return layout;
}

// The new way: the four bytes of all pixels apart, each in runs (128 + count, byte) and in plain stretches.
void read_new_runs(Cursor& cursor, std::vector<Rgbe>& line) {
  for (int skipped = 0; skipped < 4; ++skipped) cursor.byte();
  for (std::size_t component = 0; component < 4; ++component)
    for (std::size_t k = 0; k < line.size();) {
      const int code = cursor.byte();
      const bool is_run = code > 128;
      const auto count = static_cast<std::size_t>(is_run ? code - 128 : code);
      if (count == 0 || count > line.size() - k) throw Error("a run passes the end of its scan line");
      std::uint8_t value = is_run ? cursor.byte() : 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (!is_run) value = cursor.byte();
        line[k++][component] = value;
      }
    }
}

// The old way: pixels, of which (1, 1, 1, count) repeats the one before; a second one in a row counts by 256.
void read_old_runs(Cursor& cursor, std::vector<Rgbe>& line) {
  unsigned shift = 0;
  for (std::size_t k = 0; k < line.size();) {
    Rgbe pixel{};
    for (std::uint8_t& value : pixel) value = cursor.byte();
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      line[k++] = pixel;
      shift = 0;
      continue;
    }
    if (k == 0 || shift > 24) throw Error("a run repeats no pixel");
    const std::size_t count = std::size_t{pixel[3]} << shift;
    if (count > line.size() - k) throw Error("a run passes the end of its scan line");
    for (std::size_t i = 0; i < count; ++i, ++k) line[k] = line[k - 1];
    shift += 8;
  }
}

void read_scan_line(Cursor& cursor, std::vector<Rgbe>& line) {
  constexpr std::size_t kFewest = 8, kMost = 32767;  // pixels of a line that the new way codes
  const bool is_new = line.size() >= kFewest && line.size() <= kMost && cursor.peek(0) == 2 &&
                      cursor.peek(1) == 2 && cursor.peek(2) < 128;
  if (!is_new) return read_old_runs(cursor, line);
  if (static_cast<std::size_t>(cursor.peek(2) << 8 | cursor.peek(3)) != line.size())
    throw Error("a scan line has another length than the picture");
  read_new_runs(cursor, line);
}

Rgb color_of(const Rgbe& pixel) {
  if (pixel[3] == 0) return {};
  const double scale = std::ldexp(1.0, int{pixel[3]} - 136);
  return {scale * pixel[0], scale * pixel[1], scale * pixel[2]};
}

Image read_picture(std::string_view bytes, std::uint64_t more_bytes_per_pixel) {
  Cursor cursor(bytes);
  const Header header = read_header(cursor);
  const Layout layout = read_layout(cursor.line());
  require_picture_memory("the header", layout.width, layout.height, 3 * sizeof(float) + more_bytes_per_pixel,
                         bytes.size());
  Image image(layout.width, layout.height);
  std::vector<Rgbe> line(static_cast<std::size_t>(layout.length()));
  for (int i = 0; i < layout.lines(); ++i) {
    read_scan_line(cursor, line);
    for (int k = 0; k < layout.length(); ++k)
      layout.set(image, i, k, color_of(line[static_cast<std::size_t>(k)]) / header.scale);
  }
  if (header.has_primaries) convert_to_rec709(image, header.primaries);
  return image;
}

}  // namespace

bool is_radiance_hdr(std::string_view bytes) { return bytes.starts_with("#?"); }

Image parse_radiance_hdr(std::string_view bytes, const std::string& name,
                         std::uint64_t more_bytes_per_pixel) {
  try {
    Image image = read_picture(bytes, more_bytes_per_pixel);
    require_finite("the picture", image);
    return image;
  } catch (const Error& error) {
    throw Error(fmt::format("{}: cannot read the Radiance picture: {}", name, error.what()));
  }
}

}  // namespace sunbeam
