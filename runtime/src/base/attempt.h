// This turns exceptions into Results. It is no public header: those compile without exceptions too.
#pragma once

#include <exception>
#include <new>

#include "sunbeam/core/result.h"

namespace sunbeam {
inline namespace v1 {

// Returns what `make` returns, or the message of what it throws. This is where exceptions end.
template <class Make>
auto attempt(Make make) -> Result<decltype(make())> {
  using Made = Result<decltype(make())>;
  try {
    return make();
  } catch (const std::bad_alloc&) {
    return Made::failure("out of memory");
  } catch (const std::exception& error) {
    return Made::failure(error.what());
  }
}

}  // namespace v1
}  // namespace sunbeam
