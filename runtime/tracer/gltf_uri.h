// This file finds what the uri of a glTF buffer stands for.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sunbeam {

bool is_data_uri(std::string_view uri);

// Returns the bytes within a data URI. Throws Error if they are not in base64.
std::string read_data_uri(std::string_view uri);

// Returns the path of a regular file, symbolic links resolved, that a percent-encoded `uri` names from
// folders[0]. Throws Error if there is none, or if it lies outside all `folders`, by `..` or a symbolic link.
std::string resolve_uri(std::string_view uri, const std::vector<std::string>& folders);

}  // namespace sunbeam
