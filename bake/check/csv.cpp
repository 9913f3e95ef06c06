#include "bake/check/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <set>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

// Commas inside double quotes do not separate. Empty if a quote is not closed.
std::vector<std::string> split_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return quoted ? std::vector<std::string>() : cells;
}

void refuse_repeated(const Csv& csv, std::size_t line) {
  std::set<std::string> seen;
  for (const auto& column : csv.header)
    if (!seen.insert(column).second)
      throw Error(fmt::format("{}:{}: column '{}' comes twice in the header", csv.name, line, column));
}

}  // namespace

std::optional<std::size_t> Csv::column(const std::string& key) const {
  const auto at = std::find(header.begin(), header.end(), key);
  if (at == header.end()) return {};
  return static_cast<std::size_t>(at - header.begin());
}

double Csv::number(const CsvRow& row, std::size_t column, double low, double high, bool closed) const {
  double value = 0;
  const bool parsed = parse_number(row.cells[column], value);
  if (!parsed || !(value >= low) || !(closed ? value <= high : value < high))
    throw Error(fmt::format("{}:{}: column '{}': found '{}'; allowed: a number, {} to {}{}", name, row.line,
                            header[column], row.cells[column], low, closed ? "" : "below ", high));
  return value;
}

Csv read_csv(std::istream& in, const std::string& name) {
  Csv csv;
  csv.name = name;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a spreadsheet's byte order mark
    if (line.empty() || line.front() == '#') continue;
    auto cells = split_cells(line);
    if (cells.empty()) throw Error(fmt::format("{}:{}: a quote is opened and not closed", name, number));
    if (csv.header.empty()) {
      csv.header = std::move(cells);
      refuse_repeated(csv, number);
    } else if (cells.size() != csv.header.size()) {
      throw Error(fmt::format("{}:{}: found {} cells; the header has {}", name, number, cells.size(),
                              csv.header.size()));
    } else {
      csv.rows.push_back({number, std::move(cells)});
    }
  }
  if (csv.header.empty()) throw Error(name + ": no header line found");
  return csv;
}

}  // namespace sunbeam
