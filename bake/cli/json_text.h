// This file writes JSON that every reader takes, whatever bytes a file name or a file holds.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sunbeam {

// Returns the text of `json`, indented. Bytes that are not UTF-8 become U+FFFD.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace sunbeam
