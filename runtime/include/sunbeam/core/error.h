// The one exception of Sunbeam. The message is complete: file, key or line, what was found, what is allowed.
#pragma once

#include <stdexcept>

namespace sunbeam::inline v1 {

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sunbeam::inline v1
