// This file holds the neutral form between a Table and a file: text attributes and named arrays. Checks are
// in table_checks.h.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sunbeam/table.h"
#include "sunbeam/table_io.h"

namespace sunbeam {
inline namespace v1 {

using Attributes = std::map<std::string, std::string>;

struct TableParts {
  Attributes attributes;  // keys without prefix
  std::vector<NdArray> arrays;
};

// Returns the attributes of a table's file, its content hash among them. Throws Error if the table is empty
// or holds a value that is not finite.
Attributes attributes_of(const TableView& table);

// Builds a table. It checks schema, names, ranks, sizes, finiteness and the content hash before. Throws Error
// whose message starts with `name`.
Table from_parts(TableParts parts, const std::string& name);

// These write axes as text attributes of one array, and read them back.
Attributes describe_axes(const std::vector<Axis>& axes);
std::vector<Axis> parse_axes(const Attributes& attributes, const std::string& array_name);

inline constexpr const char* kAttributePrefix = "sunbeam.";

}  // namespace v1
}  // namespace sunbeam
