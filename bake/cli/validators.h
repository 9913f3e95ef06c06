// This file holds checks of the command line that CLI11 does not have: its own let "-1" wrap round to a large
// number, and take "nan" for a number in any range.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace sunbeam {

// Allows decimal digits only.
CLI::Validator whole_number(std::uint64_t low, std::uint64_t high);

// Allows a decimal number, such as 2, -0.5 or 1e-3, between the bounds.
CLI::Validator number(double low, double high);

// Allows the same without bounds, "inf" and "nan" among them; a command that knows the bounds refuses those.
CLI::Validator any_number();

// Allows any text but the empty one.
CLI::Validator file_path();

}  // namespace sunbeam
