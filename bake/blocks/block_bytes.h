// This file turns numbers into the bytes of a block and back, in the byte order of the processor.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "sunbeam/core/error.h"

namespace sunbeam {

template <class T>
void append(std::string& bytes, std::span<const T> values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

// Returns the numbers that `bytes` hold. Throws Error unless they are `count` numbers.
template <class T>
std::vector<T> unpacked(const std::string& bytes, std::size_t count) {
  if (bytes.size() != count * sizeof(T)) throw Error("a block of the bake has the wrong size");
  std::vector<T> values(count);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace sunbeam
