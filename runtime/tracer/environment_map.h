// This file reads the lat-long pictures that environments are made of, from OpenEXR and Radiance files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "runtime/tracer/image.h"

namespace sunbeam {

struct EnvironmentMap {
  Image map;                          // linear Rec.709, finite, >= 0
  std::vector<std::string> warnings;  // a line each: what differs from the file
};

// Reads the display window of an EXR, black where the data window has no pixel, or a Radiance picture; the
// content decides which. Negative values become 0 with a warning that counts them. Throws Error naming the
// file if it is neither, cannot be read, is a cube map, has values that are not finite, or asks for too much
// memory.
EnvironmentMap load_environment_map(const std::string& path);
// Reads the same from the bytes of a file.
EnvironmentMap parse_environment_map(std::string_view bytes, const std::string& name);

}  // namespace sunbeam
