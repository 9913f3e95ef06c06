// This file reads CSV files with a header. Lines that start with '#' and empty lines are skipped; cells keep
// their text.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace sunbeam {

struct CsvRow {
  std::size_t line;
  std::vector<std::string> cells;
};

struct Csv {
  std::string name;
  std::vector<std::string> header;
  std::vector<CsvRow> rows;

  std::optional<std::size_t> column(const std::string& key) const;
  // Returns the cell as a number. Throws Error naming file, line and column unless it is finite and in [low,
  // high), or in [low, high] if closed.
  double number(const CsvRow& row, std::size_t column, double low, double high, bool closed) const;
};

// Reads a file whose name in messages is `name`. Throws Error if there is no header, a column's name comes
// twice, or a row has another number of cells than the header.
Csv read_csv(std::istream& in, const std::string& name);

}  // namespace sunbeam
