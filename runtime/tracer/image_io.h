// Pictures on disk. Every file is written beside its target under a temporary name and renamed, so a reader
// never sees half a picture. All functions throw Error naming the file.
#pragma once

#include <map>
#include <string>

#include "runtime/tracer/image.h"
#include "sunbeam/core/color_space.h"

namespace sunbeam {

struct ExrImage {
  Image mean;
  Image variance;  // of the pixel mean; empty if the file has none
  std::map<std::string, std::string> attributes;
};

// Channels R, G, B and, unless `variance` is empty, variance.R, variance.G, variance.B; all 32-bit float,
// linear Rec.709 (and the header says so), signs kept. `attributes` become string attributes of the header.
void write_exr(const std::string& path, const ExrImage& image);

// Reads R, G, B of any pixel type as float, the variance layer where there is one, and all string attributes.
ExrImage read_exr(const std::string& path);

// 8-bit sRGB after display_color() on every pixel. Negative components, which a PNG cannot hold, are raised
// to 0: returns how often and how much light that added.
ClipAccount write_png(const std::string& path, const Image& image);

// The content of such a file; the image must not be empty.
std::string png_bytes(const Image& image, ClipAccount& account);

// Scene-linear to display-linear, [0, 1]. Up to 0.5 nothing changes; above, a smooth shoulder approaches 1.
// Half of the result keeps the ratios of the channels, so that a bright iridescent highlight keeps its hue,
// and half compresses each channel alone, so that a very bright one still turns towards white.
Rgb display_color(const Rgb& scene_linear);

}  // namespace sunbeam
