// This file reads a file's bytes from front to back and never beyond them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "sunbeam/core/error.h"

namespace sunbeam {
inline namespace v1 {

class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes) : bytes_(bytes) {}

  std::size_t position() const { return position_; }
  std::size_t left() const { return bytes_.size() - position_; }

  // Returns the next `count` bytes. Throws Error if there are fewer; `what` names what they are.
  std::string_view take(std::uint64_t count, const char* what) {
    if (count > left()) fail(count, what);
    const std::string_view taken = bytes_.substr(position_, count);
    position_ += count;
    return taken;
  }

  // Returns the next number of this type, little-endian as it is stored.
  template <class Number>
  Number number(const char* what) {
    Number value;
    std::memcpy(&value, take(sizeof value, what).data(), sizeof value);
    return value;
  }

  // Returns a text that has its length in front. Throws Error if it is longer than `longest`.
  std::string_view text(const char* what, std::uint32_t longest) {
    const auto length = number<std::uint32_t>(what);
    if (length > longest)
      throw Error(std::string(what) + " is " + std::to_string(length) + " bytes long; allowed: up to " +
                  std::to_string(longest));
    return take(length, what);
  }

 private:
  [[noreturn]] void fail(std::uint64_t count, const char* what) const {
    throw Error("the file ends within " + std::string(what) + ": it claims " + std::to_string(count) +
                " bytes at byte " + std::to_string(position_) + ", and " + std::to_string(left()) +
                " are left");
  }

  std::string_view bytes_;
  std::size_t position_ = 0;
};

}  // namespace v1
}  // namespace sunbeam
