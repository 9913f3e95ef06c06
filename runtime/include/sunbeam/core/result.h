// A Result is a value or the text of an error, for hosts that do not want exceptions. The functions that
// throw stand beside those that return it: try_load_table_exr() in table_io.h, try_bind() in table_bsdf.h.
#pragma once

#include <string>
#include <utility>
#include <variant>

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

  const T& operator*() const& { return value(); }
  T operator*() && { return std::move(value()); }
  const T* operator->() const { return &value(); }

 private:
  struct Failure {
    std::string message;
  };
  explicit Result(Failure failure) : content_(std::in_place_index<1>, std::move(failure)) {}

  std::variant<T, Failure> content_;
};

}  // namespace v1
}  // namespace sunbeam
