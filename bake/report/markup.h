// This file prepares text and pictures for use inside HTML and SVG.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <type_traits>

#include "runtime/tracer/image.h"

namespace sunbeam {

// Escapes the characters that mean something in markup, so that the text also fits in attributes. Control
// characters and bytes that are not UTF-8, which no document may hold, become U+FFFD.
std::string escape_markup(std::string_view text);

// Holds markup, as against text, which has to be escaped in it.
struct Markup {
  std::string text;
};

inline Markup operator+(const Markup& a, const Markup& b) { return {a.text + b.text}; }
inline Markup& operator+=(Markup& a, const Markup& b) { return a.text += b.text, a; }

template <class T>
inline constexpr bool is_text = std::is_convertible_v<const T&, std::string_view>;

template <class T>
using InMarkup = std::conditional_t<is_text<T> || std::is_same_v<T, Markup>, std::string, T>;

template <class T>
InMarkup<T> in_markup(const T& value) {
  if constexpr (is_text<T>)
    return escape_markup(value);
  else if constexpr (std::is_same_v<T, Markup>)
    return value.text;
  else
    return value;
}

// Formats markup as fmt::format does. Every text among `values` is escaped; Markup stays as it is.
template <class... Values>
Markup format_markup(fmt::format_string<InMarkup<Values>...> format, const Values&... values) {
  return {fmt::format(format, in_markup(values)...)};
}

std::string base64(std::string_view bytes);

// Returns a linear Rec.709 picture as a PNG inside a URI, so that a page needs no other file.
std::string png_data_uri(const Image& image);

}  // namespace sunbeam
