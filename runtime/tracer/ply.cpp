#include "runtime/tracer/ply.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstring>
#include <optional>
#include <sstream>
#include <string_view>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

Type type_of(const std::string& name) {
  static const std::array<std::array<const char*, 2>, 8> names = {{{"char", "int8"},
                                                                   {"uchar", "uint8"},
                                                                   {"short", "int16"},
                                                                   {"ushort", "uint16"},
                                                                   {"int", "int32"},
                                                                   {"uint", "uint32"},
                                                                   {"float", "float32"},
                                                                   {"double", "float64"}}};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (name == names[i][0] || name == names[i][1]) return static_cast<Type>(i);
  throw Error(fmt::format("found the type '{}'; allowed: char to double", name));
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties = {};
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  // in bytes
};

Format format_of(const std::string& name) {
  if (name == "ascii") return Format::ascii;
  if (name == "binary_little_endian") return Format::little_endian;
  if (name == "binary_big_endian") return Format::big_endian;
  throw Error(
      fmt::format("found the format '{}'; allowed: ascii, binary_little_endian, binary_big_endian", name));
}

void read_property(std::istringstream& words, Header& header) {
  Property property;
  std::string type, count_type;
  words >> type;
  if (type == "list") {
    words >> count_type >> type;
    property.count_type = type_of(count_type);
  }
  property.type = type_of(type);
  words >> property.name;
  if (header.elements.empty()) throw Error("found a property before any element");
  header.elements.back().properties.push_back(property);
}

Header read_header(const std::string& bytes) {
  Header header;
  std::istringstream lines(bytes);
  std::string line;
  if (!std::getline(lines, line) || !line.starts_with("ply")) throw Error("does not begin with 'ply'");
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string keyword, name;
    words >> keyword;
    if (keyword == "format") {
      words >> name;
      header.format = format_of(name);
    } else if (keyword == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) throw Error("found an element without name and count");
      header.elements.push_back(element);
    } else if (keyword == "property") {
      read_property(words, header);
    } else if (keyword == "end_header") {
      header.size = std::min(bytes.size(), static_cast<std::size_t>(lines.tellg()));
      return header;
    }
  }
  throw Error("the header has no end");
}

// The numbers behind the header, one after another.
class Numbers {
 public:
  Numbers(std::string_view bytes, Format format) : bytes_(bytes), format_(format) {}

  double next(Type type) {
    if (format_ == Format::ascii) return next_word();
    switch (type) {
      case Type::int8:
        return raw<std::int8_t>();
      case Type::uint8:
        return raw<std::uint8_t>();
      case Type::int16:
        return raw<std::int16_t>();
      case Type::uint16:
        return raw<std::uint16_t>();
      case Type::int32:
        return raw<std::int32_t>();
      case Type::uint32:
        return raw<std::uint32_t>();
      case Type::float32:
        return raw<float>();
      default:
        return raw<double>();
    }
  }

 private:
  [[noreturn]] static void fail_short() { throw Error("ends before its last number"); }

  double next_word() {
    const std::size_t begin = bytes_.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) fail_short();
    bytes_.remove_prefix(begin);
    const std::string_view word = bytes_.substr(0, bytes_.find_first_of(" \t\r\n"));
    double value = 0;
    const char* first = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto parsed = std::from_chars(first, word.data() + word.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != word.data() + word.size())
      throw Error(fmt::format("found '{}'; allowed: a number", word));
    bytes_.remove_prefix(word.size());
    return value;
  }

  template <class T>
  double raw() {
    if (bytes_.size() < sizeof(T)) fail_short();
    std::array<char, sizeof(T)> copy;
    std::memcpy(copy.data(), bytes_.data(), sizeof(T));
    if (format_ == Format::big_endian) std::reverse(copy.begin(), copy.end());
    T value;
    std::memcpy(&value, copy.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
    return static_cast<double>(value);
  }

  std::string_view bytes_;
  Format format_;
};

// Where in a row of numbers `names` stand; empty unless all do.
std::vector<std::size_t> places(const Element& element, const std::vector<std::string>& names) {
  std::vector<std::size_t> found;
  for (const std::string& name : names)
    for (std::size_t i = 0; i < element.properties.size(); ++i)
      if (element.properties[i].name == name && !element.properties[i].count_type) found.push_back(i);
  return found.size() == names.size() ? found : std::vector<std::size_t>{};
}

// One number for each property, 0 for a list, whose entries go to `use_list`.
template <class UseList>
void read_row(Numbers& numbers, const Element& element, std::vector<double>& row, UseList use_list) {
  row.assign(element.properties.size(), 0);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Property& property = element.properties[i];
    if (!property.count_type) {
      row[i] = numbers.next(property.type);
      continue;
    }
    const double count = numbers.next(*property.count_type);
    if (!(count >= 0)) throw Error(fmt::format("found a list of {:g} entries", count));
    std::vector<double> entries;
    for (double k = 0; k < count; ++k) entries.push_back(numbers.next(property.type));
    use_list(property, entries);
  }
}

void read_vertices(Numbers& numbers, const Element& element, Mesh& mesh) {
  const auto position = places(element, {"x", "y", "z"}), normal = places(element, {"nx", "ny", "nz"});
  std::vector<std::size_t> uv;
  for (const auto& names : {std::vector<std::string>{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}})
    if (uv.empty()) uv = places(element, names);
  if (position.empty()) throw Error("its vertices have no x, y, z");
  if (!mesh.positions.empty()) throw Error("found the element vertex a second time");
  std::vector<double> row;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    read_row(numbers, element, row, [](const Property&, const std::vector<double>&) {});
    const auto vec = [&](const std::vector<std::size_t>& at) {
      return Vec3{row[at[0]], row[at[1]], row[at[2]]};
    };
    mesh.positions.push_back(vec(position));
    if (!normal.empty()) mesh.normals.push_back(vec(normal));
    if (!uv.empty()) mesh.uvs.push_back({row[uv[0]], row[uv[1]]});
  }
}

std::uint32_t checked_index(double index, std::size_t count) {
  if (!(index >= 0 && index < static_cast<double>(count)))
    throw Error(fmt::format("face index {:g}; allowed: 0 to {}", index, static_cast<long>(count) - 1));
  return static_cast<std::uint32_t>(index);
}

void read_faces(Numbers& numbers, const Element& element, std::vector<std::vector<double>>& faces) {
  std::vector<double> row;
  for (std::uint64_t i = 0; i < element.count; ++i)
    read_row(numbers, element, row, [&](const Property& property, const std::vector<double>& entries) {
      if (property.name == "vertex_indices" || property.name == "vertex_index") faces.push_back(entries);
    });
}

void add_faces(const std::vector<std::vector<double>>& faces, Mesh& mesh) {
  for (const auto& face : faces)
    for (std::size_t k = 2; k < face.size(); ++k)
      mesh.triangles.push_back({checked_index(face[0], mesh.positions.size()),
                                checked_index(face[k - 1], mesh.positions.size()),
                                checked_index(face[k], mesh.positions.size())});
}

Mesh parse(const std::string& bytes) {
  const Header header = read_header(bytes);
  Numbers numbers(std::string_view(bytes).substr(header.size), header.format);
  Mesh mesh;
  std::vector<std::vector<double>> faces;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    if (element.name == "vertex")
      read_vertices(numbers, element, mesh);
    else
      read_faces(numbers, element, faces);
  }
  add_faces(faces, mesh);
  return mesh;
}

}  // namespace

LoadedMesh load_ply(const std::string& path) {
  const std::string bytes = read_file(path);
  try {
    return checked_mesh(path, parse(bytes));
  } catch (const Error& error) {
    const std::string message = error.what();
    throw Error(message.starts_with(path) ? message : path + ": not a valid PLY file: " + message);
  }
}

}  // namespace sunbeam
