#include "bake/cli/validators.h"

#include <fmt/format.h>

#include "sunbeam/detail/text.h"

namespace sunbeam {

CLI::Validator whole_number(std::uint64_t low, std::uint64_t high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        std::uint64_t value = 0;
        if (parse_whole_number(text, value) && value >= low && value <= high) return std::string();
        return fmt::format("found '{}'; allowed: a whole number, {} to {}", text, low, high);
      },
      "");
}

CLI::Validator number(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        double value = 0;
        if (parse_number(text, value) && value >= low && value <= high) return std::string();
        return fmt::format("found '{}'; allowed: a number, {:g} to {:g}", text, low, high);
      },
      "");
}

CLI::Validator any_number() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        return parse_number(text, value) ? "" : fmt::format("found '{}'; allowed: a number", text);
      },
      "");
}

CLI::Validator file_path() {
  return CLI::Validator(
      [](std::string& text) { return std::string(text.empty() ? "found ''; allowed: a path" : ""); }, "");
}

}  // namespace sunbeam
