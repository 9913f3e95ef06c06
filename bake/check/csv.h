// This file reads CSV files with a header, after RFC 4180: cells in double quotes may hold commas, line ends
// and doubled quotes. Lines may end with LF, CRLF or CR. Empty lines and lines that start with '#' are
// skipped.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sunbeam {

struct CsvRow {
  std::size_t line;  // the first of the row, counted from 1
  std::vector<std::string> cells;
};

struct Csv {
  std::string name;
  std::vector<std::string> header;  // without the blanks around names
  std::vector<CsvRow> rows;

  std::optional<std::size_t> column(const std::string& key) const;
  // Returns the cell as a number. Throws Error naming file, line and column unless it is finite and in [low,
  // high), or in [low, high] if closed.
  double number(const CsvRow& row, std::size_t column, double low, double high, bool closed) const;
};

// Reads a text whose name in messages is `name`. Throws Error if there is no header, a column's name comes
// twice, a row has another number of cells than the header, or quotes are not where RFC 4180 has them.
Csv parse_csv(std::string_view text, const std::string& name);

// Returns the cells as they are written to a CSV file, without a line end: in quotes where they need them.
std::string csv_line(const std::vector<std::string>& cells);

// Returns the text without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

}  // namespace sunbeam
