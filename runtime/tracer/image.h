// This file holds a picture in memory: linear Rec.709 RGB, 3 floats per pixel, rows from the top, pixels from
// the left.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {

// Names the pixels [x0, x1) x [y0, y1) of a picture of width x height, counted from its top left corner.
struct PixelWindow {
  int width = 0, height = 0;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  static PixelWindow whole(int width, int height) { return {width, height, 0, 0, width, height}; }
  int columns() const { return x1 - x0; }
  int rows() const { return y1 - y0; }
  bool operator==(const PixelWindow&) const = default;
};

struct Image {
  int width = 0, height = 0;
  std::vector<float> rgb;

  Image() = default;
  // Makes a picture that is all black.
  Image(int w, int h)
      : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

  bool empty() const { return rgb.empty(); }

  Rgb get(int x, int y) const { return at(index(x, y) / 3); }
  // Returns a pixel by its place in the rows.
  Rgb at(std::size_t i) const { return {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}; }
  void set(int x, int y, const Rgb& value) {
    float* pixel = &rgb[index(x, y)];
    for (int channel = 0; channel < 3; ++channel) pixel[channel] = static_cast<float>(value[channel]);
  }

 private:
  std::size_t index(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

// Throws Error, which begins with `name: `, if a picture with so many bytes a pixel, and `bytes_beside` it,
// are more than a file of `file_bytes` may ask for (sunbeam/core/read_limit.h). Width and height are >= 0.
void require_picture_memory(const std::string& name, int width, int height, std::uint64_t bytes_per_pixel,
                            std::uint64_t file_bytes, std::uint64_t bytes_beside = 0);

// Throws Error, which names the file, channel and pixel of the first value that is not finite.
void require_finite(const std::string& name, const Image& image);

// Takes the pixels of a window, `channels` values each, to the whole picture: 0 where the window has none,
// and without what lies beyond the picture. `window` may lie anywhere.
std::vector<float> in_whole_picture(const std::vector<float>& values, std::size_t channels,
                                    const PixelWindow& window);

}  // namespace sunbeam
