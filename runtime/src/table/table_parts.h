// This file holds the neutral form between a Table and a file: text attributes and named arrays. Checks are
// in table_checks.h.
#pragma once

#include <string>
#include <vector>

#include "runtime/src/table/attributes.h"
#include "sunbeam/table.h"
#include "sunbeam/table_io.h"

namespace sunbeam {
inline namespace v1 {

struct TableParts {
  Attributes attributes;
  std::vector<NdArray> arrays;
};

// Returns the attributes of a table's file, its content hash among them. Throws Error if the table is empty
// or holds a value that is not finite.
Attributes attributes_of(const TableView& table);

// Builds a table. It checks schema, names, ranks, sizes, finiteness and the content hash before. Throws Error
// whose message starts with `name`.
Table from_parts(TableParts parts, const std::string& name);

}  // namespace v1
}  // namespace sunbeam
