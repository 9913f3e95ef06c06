// This returns the message of the Error that a call throws, for tests of messages.
#pragma once

#include <string>

#include "sunbeam/core/error.h"

namespace sunbeam::test {

// Returns "" if the call throws no Error.
template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace sunbeam::test
