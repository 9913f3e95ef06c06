#include "sunbeam/core/read_limit.h"

#include <algorithm>
#include <atomic>

#include "sunbeam/core/error.h"

namespace sunbeam {
inline namespace v1 {
namespace {

#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr std::uint64_t kAlwaysAllowed = 64000000;  // what is left of a second is for more inputs
#else
constexpr std::uint64_t kAlwaysAllowed = 1000000000;
#endif
constexpr std::uint64_t kMultipleOfFile = 4;

std::atomic<std::uint64_t> raised_limit{0};

std::string megabytes(std::uint64_t bytes) { return std::to_string((bytes + 999999) / 1000000) + " MB"; }

}  // namespace

std::uint64_t read_limit(std::uint64_t file_bytes) {
  const std::uint64_t usual = kAlwaysAllowed + kMultipleOfFile * file_bytes;
  return std::max(usual, raised_limit.load(std::memory_order_relaxed));
}

void set_read_limit(std::uint64_t bytes) { raised_limit.store(bytes, std::memory_order_relaxed); }

void require_within_read_limit(const std::string& what, std::uint64_t bytes, std::uint64_t file_bytes) {
  const std::uint64_t limit = read_limit(file_bytes);
  if (bytes > limit)
    throw Error(what + " asks for " + megabytes(bytes) +
                " of memory; allowed for a file of this size: " + megabytes(limit));
}

}  // namespace v1
}  // namespace sunbeam
