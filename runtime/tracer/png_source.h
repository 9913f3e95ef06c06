// This file reads the numbers of PNG files as they are stored, whatever the file says about colours.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/tracer/chromaticities.h"

namespace sunbeam {

// Holds 1 (grey) or 3 (R, G, B) numbers a pixel, rows from the top. Palettes are looked up, 1, 2 and 4 bits
// are spread over 0 to 255, alpha is left out.
struct PngNumbers {
  int width = 0, height = 0;
  int channels = 1;
  bool is_wide = false;             // 16 bits, the high byte first
  std::vector<std::uint8_t> bytes;  // rows without gaps

  // Returns number k, channel by channel and pixel by pixel, from 0 to largest().
  int at(std::size_t k) const { return is_wide ? bytes[2 * k] << 8 | bytes[2 * k + 1] : bytes[k]; }
  int largest() const { return is_wide ? 65535 : 255; }

  // What the file says about colours.
  bool is_srgb = false, has_profile = false;
  std::optional<double> gamma;  // 1 / 2.2 is nearly sRGB
  std::optional<Chromaticities> chromaticities;
};

bool is_png(std::string_view bytes);

// Throws Error, which begins with `name`, if the bytes are no whole PNG, or if they ask for too much memory
// together with the `more_bytes_per_pixel` that the caller makes of them.
PngNumbers parse_png(std::string_view bytes, const std::string& name, std::uint64_t more_bytes_per_pixel);

}  // namespace sunbeam
