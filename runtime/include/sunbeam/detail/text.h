// Numbers as text that reads back to the same bits.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sunbeam::inline v1 {

// Shortest decimal text that reads back exactly.
std::string to_text(double value);
std::string to_text(const std::vector<double>& values);  // separated by single spaces

// Whole text must be a number ("nan" and "inf" parse); false if not.
bool parse_number(std::string_view text, double& value);

std::vector<std::string> split(std::string_view text, char separator);

}  // namespace sunbeam::inline v1
