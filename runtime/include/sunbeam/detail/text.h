// This file turns numbers into text that reads back to the same bits, and text into numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sunbeam {
inline namespace v1 {

// Returns the shortest decimal text that reads back exactly.
std::string to_text(double value);
std::string to_text(const std::vector<double>& values);  // separated by single spaces

// Reads a number, which must be the whole text ("nan" and "inf" parse). One that is too small for a double is
// 0. Returns false if it is not a number or too large.
bool parse_number(std::string_view text, double& value);

// Reads a whole number of decimal digits alone, which must be the whole text. Returns false if it is not, or
// is larger than 2^64 - 1.
bool parse_whole_number(std::string_view text, std::uint64_t& value);

std::vector<std::string> split(std::string_view text, char separator);

// Returns the text without the byte order mark of UTF-8 that some editors put in front.
std::string_view without_byte_order_mark(std::string_view text);

// Returns the text with its control characters as \n, \t, \x1b and so on, for messages that quote what a file
// says. Bytes of UTF-8 stay as they are, except the control characters U+0080 to U+009F.
std::string printable(std::string_view text);

// Returns the beginning of a text that a message quotes: a file may hold one of megabytes.
std::string shortened(std::string_view text);

// Returns whether a text is UTF-8 without control characters other than line feeds and tabs.
bool is_plain_text(std::string_view text);

// Returns printable() of the first 60 bytes, and "..." if there are more.
std::string excerpt(std::string_view text);

}  // namespace v1
}  // namespace sunbeam
