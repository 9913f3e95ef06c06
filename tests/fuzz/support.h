// This file holds what fuzzing targets share. A target feeds a reader with bytes: reading throws Error, or it
// returns something that is sound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "sunbeam/core/error.h"

namespace sunbeam::test {

// Calls `read` with the input as text. An Error is the right answer to most inputs; everything else that is
// thrown ends the target as a finding.
template <class Read>
int fuzz(const std::uint8_t* data, std::size_t size, Read&& read) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    read(bytes);
  } catch (const Error&) {
  }
  return 0;
}

}  // namespace sunbeam::test
