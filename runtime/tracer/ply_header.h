// This file reads the header of a PLY file, which says what numbers follow, and those numbers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sunbeam {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type = {};  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties = {};

  // Returns where properties that are no lists stand in a row, {} unless all of them are there once.
  std::vector<std::size_t> places(const std::vector<std::string>& names) const;
  // Returns where the first list of one of these names stands.
  std::optional<std::size_t> list(const std::vector<std::string>& names) const;
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  // in bytes

  // Returns the element of this name, or null. Throws Error if there are two.
  const PlyElement* element(std::string_view name) const;
};

// Reads lines that end with LF, CRLF or CR, as the first one does. Throws Error without the file's name.
PlyHeader read_ply_header(std::string_view bytes);

// Reads the numbers behind the header, one after another. Every function throws Error where they end too
// early or are none.
class PlyNumbers {
 public:
  PlyNumbers(std::string_view bytes, PlyFormat format) : bytes_(bytes), format_(format) {}

  double next(PlyType type);
  // Reads how many entries of a list follow, which are there.
  std::size_t next_count(const PlyProperty& list);
  // Throws Error unless as many rows of the element may follow as it says.
  void require_rows(const PlyElement& element) const;

 private:
  double next_word();
  template <class T>
  double raw();

  std::string_view bytes_;
  PlyFormat format_;
};

// Reads the rows of an element: `use_list(place, entries)` takes each list, `use_row(row)` each row, which
// has a number for each property, 0 for a list.
template <class UseList, class UseRow>
void read_ply_rows(PlyNumbers& numbers, const PlyElement& element, UseList use_list, UseRow use_row) {
  if (element.properties.empty()) return;
  numbers.require_rows(element);
  std::vector<double> row(element.properties.size()), entries;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (!property.count_type) {
        row[k] = numbers.next(property.type);
        continue;
      }
      entries.resize(numbers.next_count(property));
      for (double& entry : entries) entry = numbers.next(property.type);
      use_list(k, entries);
    }
    use_row(row);
  }
}

}  // namespace sunbeam
