// A TableView is a table whose values may lie elsewhere than in memory, as its writers and its verification
// read it. A Table is one; so is a finished bake of a dense table, whose values are made of its blocks a few
// nodes at a time.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sunbeam/core/export.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

// Gives access to one array of a table.
class SUNBEAM_EXPORT ArrayView {
 public:
  // Returns the values of parameter nodes [first, first + count), in the order and the rounding of
  // NdArray::values(). Many threads may call it, more than once for the same nodes.
  using NodeValues = std::function<std::vector<float>(std::size_t first, std::size_t count)>;

  ArrayView(const NdArray& array) : shape_(array), in_memory_(array.values()) {}  // refers to the array
  ArrayView(ArrayShape shape, NodeValues values) : shape_(std::move(shape)), values_(std::move(values)) {}

  const ArrayShape& shape() const { return shape_; }
  // Returns such values of an array over the parameters that is not in memory.
  std::vector<float> at_nodes(std::size_t first, std::size_t count) const { return values_(first, count); }
  // Calls visit(values) for all of the array, piece by piece from its first cell on.
  void visit(const std::function<void(std::span<const float> values)>& visit) const;

 private:
  ArrayShape shape_;
  std::span<const float> in_memory_;
  NodeValues values_;  // empty if all are in memory
};

class SUNBEAM_EXPORT TableView {
 public:
  TableView(const Table& table);  // refers to the table
  TableView(Table&& table);
  // Views a dense table: `head` is all of it but the arrays `remainder` and `rest_stderr`.
  TableView(Table&& head, ArrayView remainder, ArrayView rest_stderr);

  // Holds every attribute and all arrays that are in memory.
  const Table& head() const { return *head_; }
  bool is_in_memory() const { return nodes_.empty(); }
  const Axis& parameter_axis(std::size_t k) const;

  // Returns the arrays that the table has, in the order of its file.
  std::vector<ArrayView> arrays() const;

  // Both return a table in memory; what they have to make for that is kept in `room`. around() is what one
  // parameter point is interpolated from: bound there, clamped to the grid, it gives the same bits as the
  // whole.
  const Table& whole(std::optional<Table>& room) const;
  const Table& around(const Parameters& parameters, std::optional<Table>& room) const;

  // Adds to Table::info.
  void add_info(const std::map<std::string, std::string>& info);

 private:
  std::shared_ptr<const Table> head_;
  std::vector<ArrayView> nodes_;  // remainder and rest_stderr, unless the table is in memory
};

}  // namespace v1
}  // namespace sunbeam
