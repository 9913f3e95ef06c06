#include "runtime/tracer/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr std::string_view kBlanks = " \t\v\f\r\n";

PlyType type_of(std::string_view name) {
  static constexpr std::array<std::array<std::string_view, 2>, 8> kNames = {{{"char", "int8"},
                                                                             {"uchar", "uint8"},
                                                                             {"short", "int16"},
                                                                             {"ushort", "uint16"},
                                                                             {"int", "int32"},
                                                                             {"uint", "uint32"},
                                                                             {"float", "float32"},
                                                                             {"double", "float64"}}};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<PlyType>(i);
  throw Error(fmt::format("found the type '{}'; allowed: char to double", excerpt(name)));
}

std::size_t size_of(PlyType type) {
  static constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

PlyFormat format_of(const std::vector<std::string_view>& words) {
  const std::string_view name = words.size() > 1 ? words[1] : "";
  if (words.size() != 3 || words[2] != "1.0")
    throw Error(fmt::format("found the format '{}' and not version 1.0", excerpt(name)));
  if (name == "ascii") return PlyFormat::ascii;
  if (name == "binary_little_endian") return PlyFormat::little_endian;
  if (name == "binary_big_endian") return PlyFormat::big_endian;
  throw Error(fmt::format("found the format '{}'; allowed: ascii, binary_little_endian, binary_big_endian",
                          excerpt(name)));
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    words.push_back(line.substr(0, line.find_first_of(kBlanks)));
    line.remove_prefix(words.back().size());
  }
}

PlyElement element_of(const std::vector<std::string_view>& words) {
  double count = -1;
  constexpr double kMost = 1e15;  // counts below are exact
  if (words.size() != 3 || !parse_number(words[2], count) ||
      !(count >= 0 && count <= kMost && count == std::floor(count)))
    throw Error("found an element without name and count");
  return {std::string(words[1]), static_cast<std::uint64_t>(count)};
}

PlyProperty property_of(const std::vector<std::string_view>& words) {
  const bool is_list = words.size() > 1 && words[1] == "list";
  if (words.size() != (is_list ? 5u : 3u)) throw Error("found a property without type and name");
  if (is_list) return {std::string(words[4]), type_of(words[3]), type_of(words[2])};
  return {std::string(words[2]), type_of(words[1])};
}

// Splits off the next line. `end` is how lines end.
std::string_view take_line(std::string_view& bytes, std::string_view end) {
  const std::size_t size = bytes.find(end);
  if (size == std::string_view::npos) throw Error("the header has no end");
  const std::string_view line = bytes.substr(0, size);
  bytes.remove_prefix(size + end.size());
  return line;
}

// The last line of a file without data need not end.
std::string_view line_end_of(std::string_view bytes) {
  const std::size_t end = bytes.find_first_of("\r\n");
  if (!bytes.starts_with("ply") || bytes.substr(0, end).find_last_not_of(kBlanks) != 2)
    throw Error("does not begin with 'ply'");
  if (end == std::string_view::npos) throw Error("the header has no end");
  const std::string_view rest = bytes.substr(end);
  return rest.substr(0, rest.starts_with("\r\n") ? 2 : 1);
}

}  // namespace

std::vector<std::size_t> PlyElement::places(const std::vector<std::string>& names) const {
  std::vector<std::size_t> found;
  for (const std::string& name : names)
    for (std::size_t i = 0; i < properties.size(); ++i)
      if (properties[i].name == name && !properties[i].count_type) found.push_back(i);
  return found.size() == names.size() ? found : std::vector<std::size_t>{};
}

std::optional<std::size_t> PlyElement::list(const std::vector<std::string>& names) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].count_type && std::find(names.begin(), names.end(), properties[i].name) != names.end())
      return i;
  return {};
}

const PlyElement* PlyHeader::element(std::string_view name) const {
  const PlyElement* found = nullptr;
  for (const PlyElement& element : elements) {
    if (element.name != name) continue;
    if (found) throw Error(fmt::format("found the element {} a second time", name));
    found = &element;
  }
  return found;
}

PlyHeader read_ply_header(std::string_view bytes) {
  PlyHeader header;
  const std::string_view all = bytes, line_end = line_end_of(bytes);
  bool has_format = false;
  take_line(bytes, line_end);
  for (;;) {
    const auto words = words_of(take_line(bytes, line_end));
    const std::string_view keyword = words.empty() ? "" : words[0];
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.format = format_of(words);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(element_of(words));
    } else if (keyword == "property") {
      if (header.elements.empty()) throw Error("found a property before any element");
      header.elements.back().properties.push_back(property_of(words));
    }  // all else is a comment, which not every exporter marks
  }
  if (!has_format) throw Error("the header has no format");
  header.size = all.size() - bytes.size();
  return header;
}

// --- numbers ---

double PlyNumbers::next(PlyType type) {
  if (format_ == PlyFormat::ascii) return next_word();
  switch (type) {
    case PlyType::int8:
      return raw<std::int8_t>();
    case PlyType::uint8:
      return raw<std::uint8_t>();
    case PlyType::int16:
      return raw<std::int16_t>();
    case PlyType::uint16:
      return raw<std::uint16_t>();
    case PlyType::int32:
      return raw<std::int32_t>();
    case PlyType::uint32:
      return raw<std::uint32_t>();
    case PlyType::float32:
      return raw<float>();
    default:
      return raw<double>();
  }
}

namespace {
[[noreturn]] void fail_short() { throw Error("ends before its last number"); }
}  // namespace

std::size_t PlyNumbers::next_count(const PlyProperty& list) {
  const double count = next(*list.count_type);
  if (!(count >= 0 && count == std::floor(count)))
    throw Error(fmt::format("found a list of {:g} entries", count));
  // In text an entry is a digit with a blank in front.
  const std::size_t entry = format_ == PlyFormat::ascii ? 2 : size_of(list.type);
  if (count > static_cast<double>(bytes_.size() / entry)) fail_short();
  return static_cast<std::size_t>(count);
}

void PlyNumbers::require_rows(const PlyElement& element) const {
  std::uint64_t row = 0;
  for (const PlyProperty& property : element.properties)
    row += format_ == PlyFormat::ascii ? 2 : size_of(property.count_type.value_or(property.type));
  // The first number of a text may have no blank in front.
  if (element.count > (bytes_.size() + 1) / row) fail_short();
}

double PlyNumbers::next_word() {
  const std::size_t begin = bytes_.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) fail_short();
  bytes_.remove_prefix(begin);
  const std::string_view word = bytes_.substr(0, bytes_.find_first_of(kBlanks));
  double value = 0;
  if (!parse_number(word, value)) throw Error(fmt::format("found '{}'; allowed: a number", excerpt(word)));
  bytes_.remove_prefix(word.size());
  return value;
}

template <class T>
double PlyNumbers::raw() {
  if (bytes_.size() < sizeof(T)) fail_short();
  std::array<char, sizeof(T)> copy;
  std::memcpy(copy.data(), bytes_.data(), sizeof(T));
  if (format_ == PlyFormat::big_endian) std::reverse(copy.begin(), copy.end());
  T value;
  std::memcpy(&value, copy.data(), sizeof(T));
  bytes_.remove_prefix(sizeof(T));
  return static_cast<double>(value);
}

}  // namespace sunbeam
