// Table files. Two forms hold the same content without loss: `.exr` (multi-part OpenEXR, here) and `.vdb`
// (OpenVDB grids, in table_vdb.h, an optional target). docs/reference/table_format.md draws both layouts.
//
// Every function throws Error naming the file and what is wrong; writing is atomic.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sunbeam/table.h"

namespace sunbeam::inline v1 {

Table load_table_exr(const std::string& path);
Table parse_table_exr(std::string_view bytes, const std::string& name);  // from memory; `name` for messages
std::string table_exr_bytes(const Table& table);  // the same table gives the same bytes
void save_table_exr(const Table& table, const std::string& path);

// The values of a dense table that does not fit into memory: its `remainder` and `rest_stderr` are outlines
// (NdArray::outline).
class DenseCells {
 public:
  virtual ~DenseCells() = default;
  // Of parameter nodes [first, first + count), in the order and the rounding of NdArray::values(). May be
  // asked for more than once, by many threads.
  virtual std::vector<float> remainder(std::size_t first, std::size_t count) const = 0;
  virtual std::vector<float> rest_stderr(std::size_t first, std::size_t count) const = 0;
};

// The same file as that of the table with its values, in memory for a few nodes.
void save_table_exr(const Table& outline, const DenseCells& cells, const std::string& path);

}  // namespace sunbeam::inline v1
