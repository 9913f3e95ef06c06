// This file checks the headers of an OpenEXR file before the library parses them, which allocates whatever
// they claim.
#pragma once

#include <string>
#include <string_view>

namespace sunbeam {
inline namespace v1 {

// Throws Error naming the file unless `bytes`, a whole file, begin with headers that OpenEXR can parse within
// bounds: flat scan lines or tiles, attributes of the size of their type, each once, tables of chunks that
// fit the file, data windows that so many bytes can unpack to, and all pixels as floats, with what the
// library needs beside them, within read_limit().
void check_exr_headers(std::string_view bytes, const std::string& name);

}  // namespace v1
}  // namespace sunbeam
