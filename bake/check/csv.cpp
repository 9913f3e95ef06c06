#include "bake/check/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

// Takes a text apart into rows of cells.
class CsvScanner {
 public:
  CsvScanner(std::string_view text, const std::string& name)
      : name_(name), text_(without_byte_order_mark(text)) {}

  // Reads the next row that is neither empty nor a remark. Returns false at the end of the text.
  bool next(CsvRow& row) {
    while (at_ < text_.size() && (is_line_end(text_[at_]) || text_[at_] == '#')) skip_line();
    if (at_ == text_.size()) return false;
    row = {line_, {}};
    do row.cells.push_back(cell());
    while (take(','));
    skip_line();
    return true;
  }

 private:
  bool take(char c) {
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }

  bool is_at_end_of_cell() const {
    return at_ == text_.size() || text_[at_] == ',' || is_line_end(text_[at_]);
  }

  // Goes to the start of the next line.
  void skip_line() {
    while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
    const bool is_carriage_return = take('\r');
    if (take('\n') || is_carriage_return) ++line_;
  }

  std::string cell() {
    const std::size_t start = at_;
    skip_blanks();
    if (take('"')) return quoted_cell();
    while (!is_at_end_of_cell())
      if (text_[at_++] == '"')
        fail(line_, "a quote within a cell that is not in quotes; allowed: \"two \"\"inches\"\"\"");
    return std::string(text_.substr(start, at_ - start));
  }

  // Behind the opening quote.
  std::string quoted_cell() {
    const std::size_t opened = line_;
    std::string cell;
    for (;;) {
      if (at_ == text_.size()) fail(opened, "a quote is opened and not closed");
      const char c = text_[at_++];
      if (c == '"' && !take('"')) break;
      cell += c;
      if (c == '\n' || (c == '\r' && !text_.substr(at_).starts_with('\n'))) ++line_;
    }
    skip_blanks();
    if (!is_at_end_of_cell())
      fail(line_, "text behind the closing quote of a cell; allowed: a comma or a line end");
    return cell;
  }

  [[noreturn]] void fail(std::size_t line, const char* what) const {
    throw Error(fmt::format("{}:{}: {}", name_, line, what));
  }

  const std::string& name_;
  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
};

// Spreadsheets leave columns without a name, which may be several.
void refuse_repeated(const Csv& csv, std::size_t line) {
  std::set<std::string> seen;
  for (const auto& column : csv.header)
    if (!column.empty() && !seen.insert(column).second)
      throw Error(fmt::format("{}:{}: column '{}' comes twice in the header", csv.name, line, column));
}

void refuse_other_separators(const Csv& csv, std::size_t line) {
  if (csv.header.size() > 1) return;
  for (const char separator : {';', '\t'})
    if (csv.header.front().find(separator) != std::string::npos)
      throw Error(fmt::format("{}:{}: columns are separated by {}; allowed: ','", csv.name, line,
                              separator == ';' ? "';'" : "tabs"));
}

std::string quoted_if_needed(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos && !cell.starts_with('#')) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::optional<std::size_t> Csv::column(const std::string& key) const {
  const auto at = std::find(header.begin(), header.end(), key);
  if (at == header.end()) return {};
  return static_cast<std::size_t>(at - header.begin());
}

double Csv::number(const CsvRow& row, std::size_t column, double low, double high, bool closed) const {
  double value = 0;
  const bool parsed = parse_number(trimmed(row.cells[column]), value);
  if (!parsed || !(value >= low) || !(closed ? value <= high : value < high))
    throw Error(fmt::format("{}:{}: column '{}': found '{}'; allowed: a number, {} to {}{}", name, row.line,
                            header[column], row.cells[column], low, closed ? "" : "below ", high));
  return value;
}

Csv parse_csv(std::string_view text, const std::string& name) {
  Csv csv;
  csv.name = name;
  CsvScanner scanner(text, name);
  CsvRow row;
  if (!scanner.next(row)) throw Error(name + ": no header line found");
  for (const auto& cell : row.cells) csv.header.emplace_back(trimmed(cell));
  refuse_repeated(csv, row.line);
  refuse_other_separators(csv, row.line);
  while (scanner.next(row)) {
    if (row.cells.size() != csv.header.size())
      throw Error(fmt::format("{}:{}: found {} cells; the header has {}", name, row.line, row.cells.size(),
                              csv.header.size()));
    csv.rows.push_back(std::move(row));
  }
  return csv;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const auto& cell : cells) line += (&cell == &cells.front() ? "" : ",") + quoted_if_needed(cell);
  return line;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace sunbeam
