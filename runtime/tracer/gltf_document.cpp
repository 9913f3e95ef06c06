#include "runtime/tracer/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include "runtime/tracer/gltf_uri.h"
#include "runtime/tracer/mesh_file.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr double kMostNatural = 1LL << 40;

std::uint32_t word(std::string_view bytes, std::size_t at) {
  if (at + 4 > bytes.size()) throw Error("ends too early");
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

// Returns where the quote behind a string stands, or where the text ends.
std::size_t end_of_string(std::string_view json, std::size_t begin) {
  for (std::size_t i = begin + 1;; ++i) {
    i = std::min(json.find('"', i), json.size());
    std::size_t backslashes = 0;
    while (i < json.size() && json[i - 1 - backslashes] == '\\') ++backslashes;
    if (backslashes % 2 == 0) return i;
  }
}

// Refuses what nests deeper than any real file, and values by the million in a small file. It looks at
// brackets and commas only; the parser sees to the rest.
void require_moderate(std::string_view json, std::uint64_t file_bytes) {
  constexpr long kMaxDepth = 200;
  constexpr std::uint64_t kBytesPerValue = 100;
  long depth = 0;
  std::uint64_t values = 1;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '"') i = end_of_string(json, i);
    values += c == '[' || c == '{' || c == ',';
    depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (depth > kMaxDepth) throw Error(fmt::format("its JSON is nested deeper than {}", kMaxDepth));
  }
  require_within_read_limit(fmt::format("JSON of {} values", values), kBytesPerValue * values, file_bytes);
}

Json parse_json(std::string_view text, std::uint64_t file_bytes) {
  require_moderate(text, file_bytes);
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& error) {
    throw Error(fmt::format("its JSON is damaged at byte {}", error.byte));
  } catch (const Json::out_of_range&) {
    throw Error("its JSON holds a number that is too large");
  }
}

std::size_t component_size(std::size_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      throw Error(fmt::format("found componentType {}; allowed: 5120 to 5123, 5125, 5126", type));
  }
}

// Reads numbers, `per_entry` side by side in entries `stride` bytes apart. Normalized integers are fractions
// of their largest.
template <class T>
void read_as(const char* bytes, std::size_t stride, std::size_t per_entry, bool normalized,
             std::span<double> numbers) {
  const double largest =
      normalized && std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::max()) : 1;
  for (std::size_t i = 0; i < numbers.size(); i += per_entry, bytes += stride)
    for (std::size_t k = 0; k < per_entry; ++k) {
      T value;
      std::memcpy(&value, bytes + k * sizeof(T), sizeof(T));
      numbers[i + k] = static_cast<double>(value) / largest;
      if (normalized && std::is_signed_v<T> && std::is_integral_v<T>)
        numbers[i + k] = std::max(-1.0, numbers[i + k]);
    }
}

void read_numbers(std::size_t type, const char* bytes, std::size_t stride, std::size_t per_entry,
                  bool normalized, std::span<double> numbers) {
  switch (type) {
    case 5120:
      return read_as<std::int8_t>(bytes, stride, per_entry, normalized, numbers);
    case 5121:
      return read_as<std::uint8_t>(bytes, stride, per_entry, normalized, numbers);
    case 5122:
      return read_as<std::int16_t>(bytes, stride, per_entry, normalized, numbers);
    case 5123:
      return read_as<std::uint16_t>(bytes, stride, per_entry, normalized, numbers);
    case 5125:
      return read_as<std::uint32_t>(bytes, stride, per_entry, normalized, numbers);
    default:
      return read_as<float>(bytes, stride, per_entry, normalized, numbers);
  }
}

std::size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 16;
}

// Extensions that change no geometry, or that numbers of any type take care of.
bool is_harmless(const std::string& extension) {
  static constexpr std::array<std::string_view, 7> kFamilies = {
      "KHR_technique", "KHR_materials_", "KHR_texture_", "EXT_texture_",
      "KHR_lights_",   "EXT_lights_",    "KHR_xmp"};
  static constexpr std::array<std::string_view, 3> kOthers = {"KHR_mesh_quantization", "MSFT_texture_dds",
                                                              "KHR_animation_pointer"};
  return std::any_of(kFamilies.begin(), kFamilies.end(),
                     [&](std::string_view family) { return extension.starts_with(family); }) ||
         std::find(kOthers.begin(), kOthers.end(), extension) != kOthers.end();
}

}  // namespace

std::size_t natural(const Json& value, const char* name) {
  const double number = value.is_number() ? value.get<double>() : -1;
  if (!(number >= 0 && number <= kMostNatural && number == std::floor(number)))
    throw Error(fmt::format("found {} for {}; allowed: a whole number from 0 to 2^40",
                            value.is_number() ? fmt::format("{:g}", number) : value.type_name(), name));
  return static_cast<std::size_t>(number);
}

std::size_t natural(const Json& object, const char* key, std::size_t fallback) {
  return object.contains(key) ? natural(object[key], key) : fallback;
}

const Json& required(const Json& object, const char* key) {
  if (!object.contains(key)) throw Error(fmt::format("{} is missing", key));
  return object[key];
}

std::vector<std::size_t> naturals(const Json& object, const char* key) {
  std::vector<std::size_t> result;
  if (!object.contains(key)) return result;
  for (const Json& value : object[key]) result.push_back(natural(value, key));
  return result;
}

std::vector<double> numbers(const Json& object, const char* key, std::size_t count) {
  const auto values = required(object, key).get<std::vector<double>>();
  if (values.size() != count)
    throw Error(fmt::format("{} has {} numbers; allowed: {}", key, values.size(), count));
  return values;
}

GltfDocument::GltfDocument(std::string_view bytes, std::vector<std::string> folders)
    : folders_(std::move(folders)), file_bytes_(bytes.size()) {
  if (bytes.starts_with("glTF"))
    read_glb(bytes);
  else
    json_ = parse_json(bytes, file_bytes_);
  require_known();
}

void GltfDocument::read_glb(std::string_view bytes) {
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  is_glb_ = true;
  if (word(bytes, 4) != 2) throw Error(fmt::format("is of version {}; allowed: 2", word(bytes, 4)));
  if (word(bytes, 8) > bytes.size()) throw Error("the file is cut short");
  bytes = bytes.substr(0, word(bytes, 8));
  bool has_json = false;
  for (std::size_t at = kHeader; at < bytes.size();) {
    const std::size_t size = word(bytes, at);
    const std::uint32_t type = word(bytes, at + 4);
    at += kChunkHeader;
    if (size > bytes.size() - at) throw Error("its header is damaged or the file is cut short");
    const std::string_view chunk = bytes.substr(at, size);
    if (!has_json && type != kJson) throw Error("its first chunk is not JSON");
    if (!has_json)
      json_ = parse_json(chunk, file_bytes_);
    else if (type == kBinary && binary_.empty())
      binary_ = chunk;
    has_json = true;
    at += size;
  }
  if (!has_json) throw Error("ends too early");
}

void GltfDocument::require_known() const {
  const Json& asset = required(json_, "asset");
  const std::string version = required(asset, "version").get<std::string>();
  if (!version.starts_with("2.")) throw Error(fmt::format("is of version {}; allowed: 2", excerpt(version)));
  const std::string needed = asset.value("minVersion", "2.0");
  if (needed != "2.0") throw Error(fmt::format("asks for version {}; allowed: 2.0", excerpt(needed)));
  if (!json_.contains("extensionsRequired")) return;
  for (const Json& name : json_["extensionsRequired"])
    if (!is_harmless(name.get<std::string>()))
      throw Error(
          fmt::format("requires the extension {}, which is not read", excerpt(name.get<std::string>())));
}

std::size_t GltfDocument::size(const char* list) const {
  return json_.contains(list) && json_[list].is_array() ? json_[list].size() : 0;
}

const Json& GltfDocument::entry(const char* list, std::size_t index) const {
  if (index >= size(list))
    throw Error(
        fmt::format("{} index {}; allowed: 0 to {}", list, index, static_cast<std::int64_t>(size(list)) - 1));
  return json_[list][index];
}

const std::string& GltfDocument::buffer(std::size_t index) {
  const Json& buffer = entry("buffers", index);
  const std::string& bytes = bytes_of(buffer, index);
  if (natural(required(buffer, "byteLength"), "byteLength") > bytes.size())
    throw Error(fmt::format("a buffer has {} bytes, fewer than byteLength says", bytes.size()));
  return bytes;
}

const std::string& GltfDocument::bytes_of(const Json& buffer, std::size_t index) {
  if (!buffer.contains("uri")) {
    if (!is_glb_ || index != 0) throw Error(fmt::format("buffer {} has no data", index));
    return binary_;
  }
  const auto& uri = buffer["uri"].get_ref<const std::string&>();
  const bool is_data = is_data_uri(uri);
  if (is_data && data_.contains(index)) return data_[index];
  if (is_data) return data_[index] = read_data_uri(uri);
  const std::string path = resolve_uri(uri, folders_);
  const auto [file, is_new] = files_.try_emplace(path);
  if (is_new) {
    file->second = read_file(path);
    file_bytes_ += file->second.size();
  }
  return file->second;
}

// The bytes of `count` entries of `size` bytes that an accessor, or a part of a sparse one, points to.
GltfDocument::Elements GltfDocument::elements(const Json& source, std::size_t size, std::size_t count) {
  const Json& view = entry("bufferViews", required(source, "bufferView"));
  if (view.contains("extensions") && view["extensions"].contains("EXT_meshopt_compression"))
    throw Error("is compressed (EXT_meshopt_compression); allowed: plain data");
  const std::string& bytes = buffer(natural(required(view, "buffer"), "buffer"));
  const std::size_t stride = natural(view, "byteStride", size), view_at = natural(view, "byteOffset", 0),
                    view_size = natural(required(view, "byteLength"), "byteLength"),
                    at = natural(source, "byteOffset", 0);
  constexpr std::size_t kMaxStride = 252;
  if (stride < size || stride > std::max(kMaxStride, size) || view_at + view_size > bytes.size() ||
      (count > 0 && at + (count - 1) * stride + size > view_size))
    throw Error(fmt::format("an accessor of {} entries reaches beyond its buffer", count));
  return {bytes.data() + view_at + at, stride};
}

void GltfDocument::count_numbers(std::size_t numbers) {
  constexpr std::uint64_t kBytesPerNumber = 16;
  numbers_ += numbers;
  require_within_read_limit(fmt::format("a mesh of {} numbers", numbers_), kBytesPerNumber * numbers_,
                            file_bytes_);
}

std::vector<double> GltfDocument::values(const Json& index, const char* type) {
  const Json& accessor = entry("accessors", index);
  const std::string found = required(accessor, "type").get<std::string>();
  if (found != type)
    throw Error(fmt::format("accessor {} has the type {}; allowed: {}", natural(index, "accessor"),
                            excerpt(found), type));
  const std::size_t components = components_of(type), count = natural(required(accessor, "count"), "count"),
                    number_type = natural(required(accessor, "componentType"), "componentType"),
                    size = component_size(number_type);
  const bool normalized = accessor.value("normalized", false), has_data = accessor.contains("bufferView");
  Elements from = {};
  if (has_data) from = elements(accessor, size * components, count);
  count_numbers(components * count);
  std::vector<double> result(components * count);
  if (has_data) read_numbers(number_type, from.data, from.stride, components, normalized, result);
  if (accessor.contains("sparse")) put_sparse(accessor, components, result);
  return result;
}

void GltfDocument::put_sparse(const Json& accessor, std::size_t components, std::vector<double>& values) {
  const Json &sparse = accessor["sparse"], &places = required(sparse, "indices");
  const std::size_t count = natural(required(sparse, "count"), "count"),
                    number_type = natural(accessor["componentType"], "componentType"),
                    place_type = natural(required(places, "componentType"), "componentType");
  const Elements at = elements(places, component_size(place_type), count),
                 from = elements(required(sparse, "values"), component_size(number_type) * components, count);
  count_numbers((components + 1) * count);
  std::vector<double> indices(count), numbers(components * count);
  read_numbers(place_type, at.data, at.stride, 1, false, indices);
  read_numbers(number_type, from.data, from.stride, components, accessor.value("normalized", false), numbers);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = checked_index("sparse", indices[i], values.size() / components);
    std::copy_n(&numbers[components * i], components, &values[components * index]);
  }
}

std::vector<std::uint32_t> GltfDocument::indices(const char* name, const Json& accessor, const char* type,
                                                 std::size_t count) {
  std::vector<std::uint32_t> result;
  const std::vector<double> found = values(accessor, type);
  result.reserve(found.size());
  for (const double index : found) result.push_back(checked_index(name, index, count));
  return result;
}

}  // namespace sunbeam
