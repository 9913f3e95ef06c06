// This file splits the header of an OpenEXR part into attributes, whose sizes it checks.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "sunbeam/core/error.h"

namespace sunbeam {
inline namespace v1 {

// Reads numbers and names from bytes one after the other. Every function throws Error where they end.
class ExrBytes {
 public:
  explicit ExrBytes(std::string_view bytes) : bytes_(bytes) {}

  std::size_t left() const { return bytes_.size(); }
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw Error("its header ends too early");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  // Returns a little-endian number.
  template <class T>
  T number() {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  // Returns a name that a zero byte ends, and passes over the zero.
  std::string name();

 private:
  std::string_view bytes_;
};

struct ExrAttribute {
  std::string type;
  std::string_view value;
};
using ExrAttributes = std::map<std::string, ExrAttribute>;

// Reads the attributes of one part up to the zero byte that ends them, none if it is the first. Throws Error
// if one is there twice, its size is not that of its type, or there are too many.
ExrAttributes read_exr_attributes(ExrBytes& bytes);

}  // namespace v1
}  // namespace sunbeam
