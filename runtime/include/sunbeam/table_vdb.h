// This file reads and writes tables in OpenVDB form; see table_io.h. Link sunbeam::table_vdb.
#pragma once

#include <string>
#include <string_view>

#include "sunbeam/core/export.h"
#include "sunbeam/table_io.h"

namespace sunbeam {
inline namespace v1 {

SUNBEAM_EXPORT Table load_table_vdb(const std::string& path);
SUNBEAM_EXPORT Table parse_table_vdb(std::string_view bytes, const std::string& name);
SUNBEAM_EXPORT std::string table_vdb_bytes(const Table& table);
SUNBEAM_EXPORT void save_table_vdb(const Table& table, const std::string& path);

// These take either form, by the extension of the path.
SUNBEAM_EXPORT Table load_table(const std::string& path);
SUNBEAM_EXPORT Result<Table> try_load_table(const std::string& path);
SUNBEAM_EXPORT void save_table(const TableView& table, const std::string& path);
SUNBEAM_EXPORT std::string table_bytes(const Table& table, const std::string& path);
// Throws Error unless the extension is one of the two.
SUNBEAM_EXPORT void require_table_extension(const std::string& path);

}  // namespace v1
}  // namespace sunbeam
