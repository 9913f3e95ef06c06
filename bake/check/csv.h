// A CSV file with a header; lines that start with '#' and empty lines are skipped. Cells keep their text.
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
  // A finite number in [low, high), or in [low, high] if closed; else throws Error naming file, line and
  // column.
  double number(const CsvRow& row, std::size_t column, double low, double high, bool closed) const;
};

// Throws Error if there is no header, a name comes twice, or a row has another number of cells than the
// header.
Csv read_csv(std::istream& in, const std::string& name);

}  // namespace sunbeam
