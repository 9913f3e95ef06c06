// Returns a 128-bit content hash (XXH3) as 32 hexadecimal digits.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace sunbeam {
inline namespace v1 {

std::string content_hash(std::string_view bytes);

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
