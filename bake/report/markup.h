// This file prepares text and pictures for use inside HTML and SVG.
#pragma once

#include <string>
#include <string_view>

#include "runtime/tracer/image.h"

namespace sunbeam {

// Escapes the characters that mean something in markup, so that the text also fits in attributes.
std::string escape_markup(std::string_view text);

std::string base64(std::string_view bytes);

// Returns a linear Rec.709 picture as a PNG inside a URI, so that a page needs no other file.
std::string png_data_uri(const Image& image);

}  // namespace sunbeam
