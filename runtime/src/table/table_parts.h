// The neutral form between a Table and a file: text attributes and named arrays. Checks are in
// table_checks.h.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sunbeam/table.h"
#include "sunbeam/table_io.h"

namespace sunbeam::inline v1 {

using Attributes = std::map<std::string, std::string>;

struct TableParts {
  Attributes attributes;  // keys without prefix
  std::vector<NdArray> arrays;
};

// `cells` has the values of outlines, if there are any.
TableParts to_parts(const Table& table, const DenseCells* cells = nullptr);

// Calls visit(first cell, values) for all of an array, from its first cell on.
void visit_values(const NdArray& array, const DenseCells* cells,
                  const std::function<void(std::size_t first, std::span<const float> values)>& visit);

// Checks schema, names, ranks, sizes, finiteness and the content hash before it builds. Throws Error whose
// message starts with `name`.
Table from_parts(const TableParts& parts, const std::string& name);

// Axes as text attributes of one array, and back.
Attributes describe_axes(const std::vector<Axis>& axes);
std::vector<Axis> parse_axes(const Attributes& attributes, const std::string& array_name);

inline constexpr const char* kAttributePrefix = "sunbeam.";

}  // namespace sunbeam::inline v1
