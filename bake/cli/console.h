// This file prints. What was asked for goes to standard output, and it is an error if it cannot be written;
// what is said about it goes to standard error, and is lost if it cannot.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace sunbeam {

// Must come first in a program. It opens those of the three standard descriptors that are closed, so that a
// file that is opened later is not taken for one; printing to them fails as before. A pipe that nobody reads
// is an error to report, not a signal.
void prepare_console();

void write_output(std::string_view text);
void write_message(std::string_view text);

// Prints on standard output.
template <class... Args>
void out(fmt::format_string<Args...> format, Args&&... args) {
  write_output(fmt::format(format, std::forward<Args>(args)...));
}

// Prints a line on standard error, control characters escaped.
void message_line(std::string_view line);
template <class... Args>
void message(fmt::format_string<Args...> format, Args&&... args) {
  message_line(fmt::format(format, std::forward<Args>(args)...));
}

// Throws Error if anything of standard output could not be written. Must come last.
void require_output_written();

// Throws the same Error.
[[noreturn]] void fail_output();

}  // namespace sunbeam
