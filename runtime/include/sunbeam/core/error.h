// Sunbeam throws this exception and no other of its own. The message is complete: it names the file, the key
// or line, what was found and what is allowed.
#pragma once

#include <stdexcept>

#include "sunbeam/core/export.h"

namespace sunbeam {
inline namespace v1 {

class SUNBEAM_EXPORT Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace v1
}  // namespace sunbeam
