// The neutral form between a Table and a file: text attributes and named arrays. Checks live here, once.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sunbeam/table.h"

namespace sunbeam {

using Attributes = std::map<std::string, std::string>;

struct TableParts {
  Attributes attributes;  // keys without prefix
  std::vector<NdArray> arrays;
};

TableParts to_parts(const Table& table);

// Checks schema, names, ranks, sizes, finiteness and the content hash before it builds. Throws Error whose
// message starts with `name`.
Table from_parts(const TableParts& parts, const std::string& name);

// Axes as text attributes of one array, and back.
Attributes describe_axes(const std::vector<Axis>& axes);
std::vector<Axis> parse_axes(const Attributes& attributes, const std::string& array_name);

inline constexpr const char* kAttributePrefix = "sunbeam.";

}  // namespace sunbeam
