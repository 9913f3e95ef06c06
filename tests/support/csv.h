// Reads the reference values beside this file: lines of '#' are comments, the first other line names the
// columns.
#pragma once

#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "sunbeam/detail/text.h"
#include "sunbeam/material.h"

namespace sunbeam::test {

struct CsvRow {
  int line = 0;
  std::map<std::string, std::string> fields;

  bool has(const std::string& key) const { return fields.count(key) && !fields.at(key).empty(); }
  const std::string& text(const std::string& key) const { return fields.at(key); }
  double number(const std::string& key) const {
    double value = 0;
    if (!parse_number(text(key), value)) throw std::runtime_error(key + ": not a number: " + text(key));
    return value;
  }
};

// Throws if the file is missing, empty or ragged, so that a test over "all rows" cannot pass over none.
inline std::vector<CsvRow> read_csv(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> header;
  std::vector<CsvRow> rows;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    const auto cells = split(line, ',');
    if (header.empty()) {
      header = cells;
      continue;
    }
    if (cells.size() != header.size())
      throw std::runtime_error(path + ": ragged line " + std::to_string(number));
    CsvRow row{number, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) row.fields[header[i]] = cells[i];
    rows.push_back(row);
  }
  if (rows.empty()) throw std::runtime_error(path + ": no rows");
  return rows;
}

inline std::vector<CsvRow> read_reference(const std::string& name) {
  return read_csv(std::string(SUNBEAM_SOURCE_DIR) + "/tests/support/reference/" + name);
}

// The columns that are keys of Material.
inline Material material_of(const CsvRow& row) {
  Material material;
  for (const auto& key : material_keys())
    if (row.has(key)) set_from_text(material, key, row.text(key));
  return material;
}

inline double radians(double degrees) { return degrees * kPi / 180; }

}  // namespace sunbeam::test
