// Sunbeam throws this exception and no other of its own. The message is complete: it names the file, the key
// or line, what was found and what is allowed.
#pragma once

#include <stdexcept>

namespace sunbeam {
inline namespace v1 {

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace v1
}  // namespace sunbeam
