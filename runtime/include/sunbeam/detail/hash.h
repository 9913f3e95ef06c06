// This file makes 128-bit content hashes (XXH3) as 32 hexadecimal digits.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace sunbeam {
inline namespace v1 {

std::string content_hash(std::string_view bytes);

// Returns whether the hash that a file states is that of its content. Builds for fuzzing take every hash, so
// that inputs come past this check; no other build does.
bool is_hash_of_content(std::string_view stated, std::string_view hash_of_content);

// Makes the same hash of bytes that come piece by piece.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  void add(std::string_view bytes);
  std::string text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace v1
}  // namespace sunbeam
