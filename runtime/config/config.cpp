#include "runtime/config/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {

struct ConfigTable::Node {
  struct Document {
    toml::table values;
    std::vector<std::string> resolved;  // paths
  };
  // Copies of toml++ nodes forget their line, so every table points into the one parsed document.
  std::shared_ptr<Document> document;
  const toml::table* values;
  std::string file;
  std::string path;  // dotted path of this table, "" at the top
  std::set<std::string, std::less<>> asked;
  std::vector<std::shared_ptr<Node>> children;

  std::string full_key(std::string_view key) const {
    return path.empty() ? std::string(key) : path + "." + std::string(key);
  }

  const toml::node* ask(std::string_view key) {
    asked.emplace(key);
    return values->get(key);
  }

  std::shared_ptr<Node> child(const toml::table& table, std::string child_path) {
    children.push_back(std::make_shared<Node>(Node{document, &table, file, std::move(child_path), {}, {}}));
    return children.back();
  }
};

namespace {

// What was found, for messages: a number itself, else its kind.
std::string describe(const toml::node& node) {
  if (node.is_number()) return fmt::format("{}", *node.value<double>());
  return node.is_string()    ? "a string"
         : node.is_boolean() ? "a boolean"
         : node.is_array()   ? "a list"
         : node.is_table()   ? "a section"
                             : "a date or time";
}

// An element of a list of lists, each of `shortest` to `longest` numbers.
std::string describe_row(const toml::node& node, std::size_t shortest, std::size_t longest) {
  const toml::array* row = node.as_array();
  if (!row) return describe(node);
  if (row->size() < shortest || row->size() > longest) return fmt::format("a list of {}", row->size());
  std::vector<std::string> parts;
  for (const auto& part : *row) parts.push_back(describe(part));
  return fmt::format("[{}]", fmt::join(parts, ", "));
}

// The finite numbers of a list; none if it is no list or has anything else in it.
std::vector<double> finite_numbers(const toml::node& node) {
  const toml::array* row = node.as_array();
  std::vector<double> result;
  for (std::size_t k = 0; row && k < row->size(); ++k) {
    const auto value = (*row)[k].is_number() ? (*row)[k].value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) return {};
    result.push_back(*value);
  }
  return result;
}

std::string range_text(const Range& allowed) { return fmt::format("{} to {}", allowed.low, allowed.high); }

// The value of an override: TOML if it parses as such, else a bare string.
toml::table parse_value(const std::string& value) {
  try {
    return toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    return toml::table{{"value", value}};
  }
}

// The entry that "material[1]" names in a list of tables; none if there is no such entry.
toml::table* list_entry(toml::table& table, const std::string& section) {
  const auto bracket = section.find('[');
  const toml::array* list = table[section.substr(0, bracket)].as_array();
  std::size_t index = 0;
  const char* end = section.data() + section.size();
  const auto number = std::from_chars(section.data() + bracket + 1, end, index);
  const bool is_index = number.ec == std::errc() && number.ptr + 1 == end && *number.ptr == ']';
  if (!list || !is_index || index >= list->size()) return nullptr;
  return table[section.substr(0, bracket)][index].as_table();
}

toml::table* section_of(toml::table& table, const std::string& section) {
  if (section.find('[') != std::string::npos) return list_entry(table, section);
  if (!table.contains(section)) table.insert(section, toml::table{});
  return table[section].as_table();
}

void apply_override(toml::table& root, const std::string& text, const std::string& file) {
  const auto equals = text.find('=');
  const auto dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 || dot > equals)
    throw Error(fmt::format("{}: override '{}': expected section.key=value", file, text));
  toml::table* table = &root;
  std::string key = text.substr(0, equals);
  for (auto at = key.find('.'); at != std::string::npos; at = key.find('.')) {
    const std::string section = key.substr(0, at);
    table = section_of(*table, section);
    if (!table) throw Error(fmt::format("{}: override '{}': '{}' is not a section", file, text, section));
    key = key.substr(at + 1);
  }
  parse_value(text.substr(equals + 1)).get("value")->visit([&](auto&& node) {
    table->insert_or_assign(key, node);
  });
}

// The path without "..", where that is the same file: behind a symbolic link ".." leads above the link's end.
std::filesystem::path without_dots(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto end = [&](const fs::path& p) { return fs::weakly_canonical(fs::absolute(p, error), error); };
  const fs::path shorter = path.lexically_normal();
  const bool is_same = end(path) == end(shorter);
  return is_same && !error ? shorter : path;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j < row.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({substitute, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  const auto at =
      std::ranges::min_element(candidates, {}, [&](const auto& c) { return edit_distance(word, c); });
  return at == candidates.end() ? "" : *at;
}

ConfigTable ConfigTable::load(const std::string& path, const std::vector<std::string>& overrides) {
  return parse(read_text(path), path, overrides);
}

ConfigTable ConfigTable::parse(const std::string& text, const std::string& name,
                               const std::vector<std::string>& overrides) {
  auto document = std::make_shared<Node::Document>();
  try {
    document->values = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw Error(
        fmt::format("{}:{}: not valid TOML: {}", name, error.source().begin.line, error.description()));
  }
  for (const auto& override_text : overrides) apply_override(document->values, override_text, name);
  const toml::table* values = &document->values;
  return ConfigTable(std::make_shared<Node>(Node{std::move(document), values, name, "", {}, {}}));
}

void ConfigTable::fail(std::string_view key, const std::string& message) const {
  const toml::node* node = node_->values->get(key);
  const auto line = node ? node->source().begin.line : node_->values->source().begin.line;
  const std::string where = line ? fmt::format("{}:{}", node_->file, line) : node_->file;
  throw Error(fmt::format("{}: key '{}': {}", where, node_->full_key(key), message));
}

void ConfigTable::refuse(std::string_view key, const std::string& allowed) const {
  const toml::node* node = node_->ask(key);
  fail(key, (node ? "found " + describe(*node) : "is missing") + "; allowed: " + allowed);
}

bool ConfigTable::has(std::string_view key) const { return node_->ask(key) != nullptr; }
bool ConfigTable::has_removed(std::string_view key) const { return node_->values->contains(key) && has(key); }
bool ConfigTable::is_number(std::string_view key) const { return has(key) && node_->ask(key)->is_number(); }
bool ConfigTable::is_string(std::string_view key) const { return has(key) && node_->ask(key)->is_string(); }
bool ConfigTable::is_list(std::string_view key) const { return has(key) && node_->ask(key)->is_array(); }
bool ConfigTable::is_table(std::string_view key) const { return has(key) && node_->ask(key)->is_table(); }

bool ConfigTable::is_list_of_lists(std::string_view key) const {
  if (!is_list(key)) return false;
  const toml::array& list = *node_->ask(key)->as_array();
  return !list.empty() && list[0].is_array();
}

double ConfigTable::number(std::string_view key, const Range& allowed, std::optional<double> fallback) const {
  const toml::node* node = node_->ask(key);
  if (!node && fallback) return *fallback;
  if (!node) fail(key, fmt::format("is missing; allowed: a number, {}", range_text(allowed)));
  const auto value = node->value<double>();
  if (!node->is_number() || !value)
    fail(key, fmt::format("found {}; allowed: a number, {}", describe(*node), range_text(allowed)));
  if (!std::isfinite(*value) || *value < allowed.low || *value > allowed.high)
    fail(key, fmt::format("found {}; allowed: {}", *value, range_text(allowed)));
  return *value;
}

int ConfigTable::integer(std::string_view key, int low, int high, std::optional<int> fallback) const {
  const double value = number(key, {static_cast<double>(low), static_cast<double>(high)}, fallback);
  if (value != std::floor(value))
    fail(key, fmt::format("found {}; allowed: a whole number, {} to {}", value, low, high));
  return static_cast<int>(value);
}

bool ConfigTable::boolean(std::string_view key, bool fallback) const {
  const toml::node* node = node_->ask(key);
  if (!node) return fallback;
  if (!node->is_boolean()) fail(key, fmt::format("found {}; allowed: true or false", describe(*node)));
  return *node->value<bool>();
}

std::string ConfigTable::string(std::string_view key, std::optional<std::string> fallback) const {
  const toml::node* node = node_->ask(key);
  if (!node && fallback) return *fallback;
  if (!node) fail(key, "is missing; allowed: a string");
  if (!node->is_string()) fail(key, fmt::format("found {}; allowed: a string", describe(*node)));
  return *node->value<std::string>();
}

int ConfigTable::choice(std::string_view key, const std::vector<std::string>& allowed,
                        std::optional<int> fallback) const {
  if (!has(key) && fallback) return *fallback;
  const std::string value = string(key);
  const auto at = std::find(allowed.begin(), allowed.end(), value);
  if (at == allowed.end())
    fail(key, fmt::format("found \"{}\"; allowed: \"{}\"", value, fmt::join(allowed, "\", \"")));
  return static_cast<int>(at - allowed.begin());
}

std::vector<double> ConfigTable::numbers(std::string_view key, const Range& allowed) const {
  const toml::node* node = node_->ask(key);
  if (!node || !node->is_array())
    fail(key, fmt::format("{}; allowed: a list of numbers, each {}",
                          node ? "found " + describe(*node) : "is missing", range_text(allowed)));
  std::vector<double> result;
  for (const auto& element : *node->as_array()) {
    const auto value = element.value<double>();
    if (!element.is_number() || !value || !std::isfinite(*value) || *value < allowed.low ||
        *value > allowed.high)
      fail(key, fmt::format("element {} is {}; allowed: numbers, each {}", result.size() + 1,
                            describe(element), range_text(allowed)));
    result.push_back(*value);
  }
  return result;
}

std::vector<std::pair<double, double>> ConfigTable::curve(std::string_view key, const Range& allowed_x,
                                                          const Range& allowed_y) const {
  const std::string allowed = fmt::format("allowed: at least two pairs [{}, {}], the first number ascending",
                                          range_text(allowed_x), range_text(allowed_y));
  const auto number_of = [](const toml::array& pair, std::size_t k, const Range& range) {
    const auto value = pair[k].is_number() ? pair[k].value<double>() : std::nullopt;
    return value && std::isfinite(*value) && *value >= range.low && *value <= range.high ? value
                                                                                         : std::nullopt;
  };
  const toml::node* node = node_->ask(key);
  if (!node || !node->is_array())
    fail(key, (node ? "found " + describe(*node) : "is missing") + "; " + allowed);
  std::vector<std::pair<double, double>> result;
  for (const auto& element : *node->as_array()) {
    const toml::array* pair = element.as_array();
    const bool is_pair = pair && pair->size() == 2;
    const auto x = is_pair ? number_of(*pair, 0, allowed_x) : std::nullopt;
    const auto y = is_pair ? number_of(*pair, 1, allowed_y) : std::nullopt;
    if (!x || !y || (!result.empty() && *x <= result.back().first)) {
      fail(key, fmt::format("element {} is {}; {}", result.size() + 1, describe_row(element, 2, 2), allowed));
    }
    result.emplace_back(*x, *y);
  }
  if (result.size() < 2) fail(key, fmt::format("found {} pairs; {}", result.size(), allowed));
  return result;
}

std::vector<std::vector<double>> ConfigTable::rows(std::string_view key, std::size_t shortest,
                                                   std::size_t longest) const {
  const std::string allowed = fmt::format("a list of lists of {} to {} numbers", shortest, longest);
  const toml::node* node = node_->ask(key);
  if (!node || !node->is_array()) refuse(key, allowed);
  std::vector<std::vector<double>> result;
  for (const auto& element : *node->as_array()) {
    auto row = finite_numbers(element);
    if (row.size() < shortest || row.size() > longest)
      fail(key, fmt::format("element {} is {}; allowed: {}", result.size() + 1,
                            describe_row(element, shortest, longest), allowed));
    result.push_back(std::move(row));
  }
  return result;
}

Vec3 ConfigTable::vec3(std::string_view key, std::optional<Vec3> fallback) const {
  if (!has(key) && fallback) return *fallback;
  const auto values = numbers(key, {});
  if (values.size() != 3) fail(key, fmt::format("found {} numbers; allowed: 3", values.size()));
  return {values[0], values[1], values[2]};
}

Rgb ConfigTable::rgb(std::string_view key, const Range& allowed, std::optional<Rgb> fallback) const {
  if (!has(key) && fallback) return *fallback;
  if (!is_list(key)) return Rgb(number(key, allowed));
  const auto values = numbers(key, allowed);
  if (values.size() != 3)
    fail(key, fmt::format("found {} numbers; allowed: one number or a list of 3", values.size()));
  return {values[0], values[1], values[2]};
}

ConfigTable ConfigTable::table(std::string_view key) const {
  const toml::node* node = node_->ask(key);
  if (node && !node->is_table()) fail(key, fmt::format("found {}; allowed: a section", describe(*node)));
  static const toml::table empty;
  return ConfigTable(node_->child(node ? *node->as_table() : empty, node_->full_key(key)));
}

std::vector<ConfigTable> ConfigTable::tables(std::string_view key) const {
  const toml::node* node = node_->ask(key);
  std::vector<ConfigTable> result;
  if (!node) return result;
  if (!node->is_array()) fail(key, fmt::format("found {}; allowed: [[{}]] entries", describe(*node), key));
  for (const auto& element : *node->as_array()) {
    if (!element.is_table())
      fail(key, fmt::format("entry {} is {}; allowed: a table", result.size() + 1, describe(element)));
    result.push_back(ConfigTable(
        node_->child(*element.as_table(), fmt::format("{}[{}]", node_->full_key(key), result.size()))));
  }
  return result;
}

void ConfigTable::finish() const {
  for (const auto& [key, value] : *node_->values) {
    if (node_->asked.count(key.str())) continue;
    const std::string suggestion = nearest(key.str(), {node_->asked.begin(), node_->asked.end()});
    fail(key.str(), suggestion.empty()
                        ? "is not known"
                        : fmt::format("is not known; the nearest valid key is '{}'", suggestion));
  }
  for (const auto& child : node_->children) ConfigTable(child).finish();
}

const std::string& ConfigTable::file() const { return node_->file; }

std::string ConfigTable::resolve(const std::string& relative_path) const {
  const std::filesystem::path folder = std::filesystem::path(node_->file).parent_path();
  node_->document->resolved.push_back(without_dots(folder / relative_path).string());
  return node_->document->resolved.back();
}

const std::vector<std::string>& ConfigTable::resolved_files() const { return node_->document->resolved; }

std::string ConfigTable::canonical_text() const {
  std::ostringstream text;
  text << *node_->values;
  return text.str();
}

}  // namespace sunbeam
