// 128-bit content hash (XXH3) as 32 hexadecimal digits.
#pragma once

#include <string>
#include <string_view>

namespace sunbeam {

std::string content_hash(std::string_view bytes);

}  // namespace sunbeam
