// This file turns numbers into text that reads back to the same bits, and text into numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sunbeam {
inline namespace v1 {

// Returns the shortest decimal text that reads back exactly.
std::string to_text(double value);
std::string to_text(const std::vector<double>& values);  // separated by single spaces

// Reads a number, which must be the whole text ("nan" and "inf" parse). Returns false if it is not.
bool parse_number(std::string_view text, double& value);

std::vector<std::string> split(std::string_view text, char separator);

}  // namespace v1
}  // namespace sunbeam
