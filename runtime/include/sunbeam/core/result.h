// A Result is a value or the text of an error, for hosts that do not want exceptions. The functions that
// throw stand beside those that return it: try_load_table_exr() in table_io.h, try_bind() in table_bsdf.h.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <utility>
#include <variant>

#include "sunbeam/core/error.h"

namespace sunbeam {
inline namespace v1 {

template <class T>
class Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  static Result failure(std::string message) { return Result(Failure{std::move(message)}); }

  explicit operator bool() const { return content_.index() == 0; }
  // Only a success has a value, and only a failure has a message: the same as that of the exception.
  const T& value() const { return *std::get_if<0>(&content_); }
  T& value() { return *std::get_if<0>(&content_); }
  const std::string& error() const { return std::get_if<1>(&content_)->message; }

  const T& operator*() const { return value(); }
  const T* operator->() const { return &value(); }

 private:
  struct Failure {
    std::string message;
  };
  explicit Result(Failure failure) : content_(std::in_place_index<1>, std::move(failure)) {}

  std::variant<T, Failure> content_;
};

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
