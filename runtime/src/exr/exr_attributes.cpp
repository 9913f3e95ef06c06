#include "runtime/src/exr/exr_attributes.h"

#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::size_t kLongestName = 255;
constexpr std::size_t kMostAttributes = 4096;  // of a part

// The library reads a value of these types whatever size the file states.
std::size_t size_of_type(const std::string& type) {
  static const std::map<std::string, std::size_t> kSizes = {{"box2f", 16},
                                                            {"box2i", 16},
                                                            {"chromaticities", 32},
                                                            {"compression", 1},
                                                            {"deepImageState", 1},
                                                            {"double", 8},
                                                            {"envmap", 1},
                                                            {"float", 4},
                                                            {"int", 4},
                                                            {"keycode", 28},
                                                            {"lineOrder", 1},
                                                            {"m33d", 72},
                                                            {"m33f", 36},
                                                            {"m44d", 128},
                                                            {"m44f", 64},
                                                            {"rational", 8},
                                                            {"tiledesc", 9},
                                                            {"timecode", 8},
                                                            {"v2d", 16},
                                                            {"v2f", 8},
                                                            {"v2i", 8},
                                                            {"v3d", 24},
                                                            {"v3f", 12},
                                                            {"v3i", 12}};
  const auto at = kSizes.find(type);
  return at == kSizes.end() ? 0 : at->second;
}

bool is_whole_preview(std::string_view value) {
  ExrBytes bytes(value);
  const auto width = bytes.number<std::uint32_t>(), height = bytes.number<std::uint32_t>();
  constexpr std::uint32_t kMostPixels = 1 << 24;
  return width <= kMostPixels && height <= kMostPixels && bytes.left() == std::uint64_t{4} * width * height;
}

bool is_whole_list_of_texts(std::string_view value) {
  ExrBytes bytes(value);
  while (bytes.left() > 0) {
    const auto length = bytes.number<std::int32_t>();
    if (length < 0) return false;
    bytes.take(static_cast<std::size_t>(length));
  }
  return true;
}

// The library reads channels up to an empty name, whatever size the file states.
bool is_whole_list_of_channels(std::string_view value) {
  constexpr std::size_t kBytesOfChannel = 16;
  ExrBytes bytes(value);
  while (!bytes.name().empty()) bytes.take(kBytesOfChannel);
  return bytes.left() == 0;
}

void check_value(const std::string& name, const ExrAttribute& attribute) {
  const std::string what = "attribute '" + printable(name) + "' of type '" + printable(attribute.type) + "'";
  const std::size_t expected = size_of_type(attribute.type);
  if (expected > 0 && attribute.value.size() != expected)
    throw Error(what + " has " + std::to_string(attribute.value.size()) +
                " bytes; allowed: " + std::to_string(expected));
  if (attribute.type == "preview" && !is_whole_preview(attribute.value))
    throw Error(what + " has another size than its pixels");
  if (attribute.type == "stringvector" && !is_whole_list_of_texts(attribute.value))
    throw Error(what + " holds a text of negative length");
  if (attribute.type == "chlist" && !is_whole_list_of_channels(attribute.value))
    throw Error(what + " is not a list of channels");
}

}  // namespace

std::string ExrBytes::name() {
  const auto end = bytes_.substr(0, kLongestName + 1).find('\0');
  if (end == std::string_view::npos)
    throw Error("its header ends too early, or has a name of more than " + std::to_string(kLongestName) +
                " bytes");
  return std::string(take(end + 1).substr(0, end));
}

ExrAttributes read_exr_attributes(ExrBytes& bytes) {
  ExrAttributes attributes;
  for (;;) {
    const std::string name = bytes.name();
    if (name.empty()) return attributes;
    ExrAttribute attribute{bytes.name(), {}};
    const auto size = bytes.number<std::int32_t>();
    if (size < 0 || static_cast<std::size_t>(size) > bytes.left())
      throw Error("attribute '" + printable(name) + "' claims " + std::to_string(size) + " bytes; left are " +
                  std::to_string(bytes.left()));
    attribute.value = bytes.take(static_cast<std::size_t>(size));
    check_value(name, attribute);
    if (!attributes.emplace(name, attribute).second)
      throw Error("attribute '" + printable(name) + "' is there twice");
    if (attributes.size() > kMostAttributes)
      throw Error("a part has more than " + std::to_string(kMostAttributes) + " attributes");
  }
}

}  // namespace v1
}  // namespace sunbeam
