// This file reads and writes pictures on disk. Every file is written beside its target under a temporary name
// and renamed, so a reader never sees half a picture. All functions throw Error naming the file.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/tracer/image.h"
#include "sunbeam/core/color_space.h"

namespace sunbeam {

struct ExrImage {
  Image mean;
  Image variance;  // of the pixel mean; empty if the file has none
  std::map<std::string, std::string> attributes;
  // These are further channels by name, each of as many values as there are pixels, rows from the top.
  std::map<std::string, std::vector<float>> layers{};
  // Says where the pixels lie (the data window) in the whole picture (the display window); they are all of it
  // if not given.
  std::optional<PixelWindow> window{};
  bool is_cube_map = false;   // by the attribute envmap, which says that it is no lat-long map
  bool is_converted = false;  // from other chromaticities than those of Rec.709
};

// Adds a picture as three layers: NAME.FIRST, NAME.SECOND, NAME.THIRD of `axes`, such as albedo.R or
// normal.X.
void insert_layers(ExrImage& exr, const std::string& name, const std::string& axes, const Image& image);
// Goes the other way round; the picture is empty if a layer is missing.
Image extract_layers(const ExrImage& exr, const std::string& name, const std::string& axes);

// Writes channels R, G, B, unless `variance` is empty variance.R, variance.G, variance.B, and the layers. All
// are 32-bit float, linear Rec.709 (and the header says so), signs kept. `attributes` become string
// attributes of the header.
void write_exr(const std::string& path, const ExrImage& image);

bool is_exr(std::string_view bytes);

// Says what to read of a file beside R, G and B.
enum class ExrChannels { mean, mean_and_variance, all };

// Reads R, G and B of any pixel type as float, the variance where there is one, all other channels into
// layers, all string attributes, and the window, shifted so that the whole picture begins at 0, 0. Where the
// header states other chromaticities than those of Rec.709 (up to 1e-4), the picture is converted, adapted to
// D65 after Bradford, and has no variance. Files of Y, or of Y, RY and BY, give their R, G and B alone. Of
// several parts the first one with R, G and B is read; of mip levels the largest. Throws Error naming the
// file if it cannot be read, asks for too much memory, or has pixels whose R, G or B is not finite.
ExrImage read_exr(const std::string& path, ExrChannels channels = ExrChannels::all);
// Reads the same from the bytes of a file, if there is memory for what the caller makes of a pixel, too.
ExrImage parse_exr(std::string_view bytes, const std::string& name, ExrChannels channels = ExrChannels::all,
                   std::uint64_t more_bytes_per_pixel = 0);

// Writes 8-bit sRGB after display_color() on every pixel. Negative components, which a PNG cannot hold, are
// raised to 0: returns how often and how much light that added.
ClipAccount write_png(const std::string& path, const Image& image);

// Returns the content of such a file; the image must not be empty.
std::string png_bytes(const Image& image, ClipAccount& account);

// Takes scene-linear to display-linear, [0, 1]. Up to 0.5 nothing changes; above, a smooth shoulder
// approaches 1. Half of the result keeps the ratios of the channels, so that a bright iridescent highlight
// keeps its hue, and half compresses each channel alone, so that a very bright one still turns towards white.
Rgb display_color(const Rgb& scene_linear);

}  // namespace sunbeam
