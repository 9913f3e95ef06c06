// This file adds up the memory that a file asks for.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "sunbeam/core/read_limit.h"

namespace sunbeam {
inline namespace v1 {

class MemoryClaim {
 public:
  // `what` asks for memory, in a file of `file_bytes`.
  MemoryClaim(std::string what, std::uint64_t file_bytes) : what_(std::move(what)), file_bytes_(file_bytes) {}

  // Throws Error if the file has asked for more than require_within_read_limit() allows.
  void add(std::uint64_t bytes) {
    claimed_ += bytes;
    require_within_read_limit(what_, claimed_, file_bytes_);
  }

 private:
  std::string what_;
  std::uint64_t file_bytes_;
  std::uint64_t claimed_ = 0;
};

}  // namespace v1
}  // namespace sunbeam
