// This file reads the pictures that are compared, from EXR and PNG files.
#pragma once

#include <string>
#include <string_view>

#include "runtime/tracer/image_io.h"

namespace sunbeam {

struct Rendering {
  ExrImage picture;
  // Says that the file holds what a display shows, as a PNG does, and not the light of a scene.
  bool is_displayed = false;
  std::string note;  // a line for people; empty if there is nothing to tell
};

// Reads a picture by its content: R, G, B and variance of an EXR as read_exr() does, or a PNG of 8 or 16
// bits, whose sRGB is decoded to linear light. Throws Error, naming the file, also for values that are not
// finite, for negative variances, and for a PNG that says by gAMA or cHRM that it is not sRGB. A colour
// profile is not read, and the note says so.
Rendering read_rendering(const std::string& path);
// Reads the same from the bytes of a file.
Rendering parse_rendering(std::string_view bytes, const std::string& name);

}  // namespace sunbeam
