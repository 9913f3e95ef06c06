// A picture in memory: linear Rec.709 RGB, 3 floats per pixel, rows from the top, pixels from the left.
#pragma once

#include <cstddef>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam {

struct Image {
  int width = 0, height = 0;
  std::vector<float> rgb;

  Image() = default;
  // All black.
  Image(int w, int h)
      : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

  bool empty() const { return rgb.empty(); }

  Rgb get(int x, int y) const {
    const float* pixel = &rgb[index(x, y)];
    return {pixel[0], pixel[1], pixel[2]};
  }
  void set(int x, int y, const Rgb& value) {
    float* pixel = &rgb[index(x, y)];
    for (int channel = 0; channel < 3; ++channel) pixel[channel] = static_cast<float>(value[channel]);
  }

 private:
  std::size_t index(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

}  // namespace sunbeam
