// This file reads and writes tables. Two forms of file hold the same content without loss: `.exr` (multi-part
// OpenEXR, here) and `.vdb` (OpenVDB grids, in table_vdb.h, an optional target).
// docs/reference/table_format.md draws both layouts.
//
// Every function throws Error naming the file and what is wrong, but for try_load_table_exr(); writing is
// atomic.
#pragma once

#include <string>
#include <string_view>

#include "sunbeam/core/export.h"
#include "sunbeam/core/result.h"
#include "sunbeam/detail/table_view.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

SUNBEAM_EXPORT Table load_table_exr(const std::string& path);
SUNBEAM_EXPORT Result<Table> try_load_table_exr(const std::string& path);
SUNBEAM_EXPORT Table parse_table_exr(std::string_view bytes,
                                     const std::string& name);       // from memory; `name` for messages
SUNBEAM_EXPORT std::string table_exr_bytes(const TableView& table);  // the same table gives the same bytes
// Writes a table; one that is not in memory is written a few nodes at a time.
SUNBEAM_EXPORT void save_table_exr(const TableView& table, const std::string& path);

}  // namespace v1
}  // namespace sunbeam
