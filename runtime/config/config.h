// This file reads TOML files (recipes, scenes) and reports errors that a person can act on.
//
// A ConfigTable remembers every key it was asked for. finish() refuses any key in the file that was never
// asked for and names the nearest one that was, so a typo cannot pass silently.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {

// Holds a closed interval of allowed values.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

class ConfigTable {
 public:
  // Parses a file; `overrides` are "section.key=value" strings, the value in TOML syntax or a bare string. A
  // section may be an entry of a list, counted from 0: "material[1].albedo=0.2".
  static ConfigTable load(const std::string& path, const std::vector<std::string>& overrides = {});
  static ConfigTable parse(const std::string& text, const std::string& name,
                           const std::vector<std::string>& overrides = {});

  bool has(std::string_view key) const;
  // Does the same as has(), but the key counts as asked for only if it is there.
  bool has_removed(std::string_view key) const;
  bool is_number(std::string_view key) const;
  bool is_string(std::string_view key) const;
  bool is_list(std::string_view key) const;
  bool is_table(std::string_view key) const;
  bool is_list_of_lists(std::string_view key) const;  // by its first element

  // These return the value of a key. Each throws Error when the key is missing and no fallback is given, or
  // when type or range are wrong.
  double number(std::string_view key, const Range& allowed, std::optional<double> fallback = {}) const;
  int integer(std::string_view key, int low, int high, std::optional<int> fallback = {}) const;
  bool boolean(std::string_view key, bool fallback) const;
  std::string string(std::string_view key, std::optional<std::string> fallback = {}) const;
  // Reads one of `allowed` and returns its index.
  int choice(std::string_view key, const std::vector<std::string>& allowed,
             std::optional<int> fallback = {}) const;
  std::vector<double> numbers(std::string_view key, const Range& allowed) const;
  // Returns a curve: a list of at least two [x, y] with ascending x.
  std::vector<std::pair<double, double>> curve(std::string_view key, const Range& allowed_x,
                                               const Range& allowed_y) const;
  // Returns a list of lists, each of `shortest` to `longest` finite numbers.
  std::vector<std::vector<double>> rows(std::string_view key, std::size_t shortest,
                                        std::size_t longest) const;
  Vec3 vec3(std::string_view key, std::optional<Vec3> fallback = {}) const;
  // Reads one number (grey) or a list of three.
  Rgb rgb(std::string_view key, const Range& allowed, std::optional<Rgb> fallback = {}) const;

  // These return a section or the entries of a list. A missing [section] is an empty table; a missing
  // [[list]] has no entries.
  ConfigTable table(std::string_view key) const;
  std::vector<ConfigTable> tables(std::string_view key) const;

  // Refuses keys never asked for, here and in every sub-table handed out.
  void finish() const;

  // Throws Error: "FILE:LINE: key 'a.b': MESSAGE".
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;
  // Does the same; the message says what was found at the key, or that it is missing, and what is allowed.
  [[noreturn]] void refuse(std::string_view key, const std::string& allowed) const;

  const std::string& file() const;
  // Resolves a path that is relative to the folder of the file, links and ".." as the system does.
  std::string resolve(const std::string& relative_path) const;
  // Returns the paths that were resolved so far, here and in all tables of the document.
  const std::vector<std::string>& resolved_files() const;
  // Returns the whole document, overrides applied, as canonical TOML text.
  std::string canonical_text() const;

 private:
  struct Node;
  explicit ConfigTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}
  std::shared_ptr<Node> node_;
};

// Returns how many letters must be put in, taken out or replaced to make one of the other.
std::size_t edit_distance(std::string_view a, std::string_view b);

// Returns the candidate with the smallest edit distance to `word`.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace sunbeam
