#include "runtime/tracer/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"

namespace sunbeam {

void require_picture_memory(const std::string& name, int width, int height, std::uint64_t bytes_per_pixel,
                            std::uint64_t file_bytes, std::uint64_t bytes_beside) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 62;  // more does not change the answer
  const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  const std::uint64_t bytes = pixels > kMost / bytes_per_pixel ? kMost : pixels * bytes_per_pixel;
  require_within_read_limit(fmt::format("{}: the picture of {} x {} pixels", name, width, height),
                            bytes + bytes_beside, file_bytes);
}

void require_finite(const std::string& name, const Image& image) {
  const auto bad =
      std::find_if(image.rgb.begin(), image.rgb.end(), [](float value) { return !std::isfinite(value); });
  if (bad == image.rgb.end()) return;
  const long index = bad - image.rgb.begin();
  throw Error(fmt::format("{}: channel {} of pixel ({}, {}) from the top left is {}; allowed: finite numbers",
                          name, "RGB"[index % 3], index / 3 % image.width, index / 3 / image.width, *bad));
}

std::vector<float> in_whole_picture(const std::vector<float>& values, std::size_t channels,
                                    const PixelWindow& window) {
  const auto whole_row = channels * static_cast<std::size_t>(window.width);
  const auto row = channels * static_cast<std::size_t>(window.columns());
  std::vector<float> whole(whole_row * static_cast<std::size_t>(window.height));
  const int x0 = std::max(window.x0, 0), x1 = std::min(window.x1, window.width);
  if (x0 >= x1) return whole;
  for (int y = std::max(window.y0, 0); y < std::min(window.y1, window.height); ++y) {
    const float* from = values.data() + row * static_cast<std::size_t>(y - window.y0) +
                        channels * static_cast<std::size_t>(x0 - window.x0);
    std::copy_n(
        from, channels * static_cast<std::size_t>(x1 - x0),
        whole.data() + whole_row * static_cast<std::size_t>(y) + channels * static_cast<std::size_t>(x0));
  }
  return whole;
}

}  // namespace sunbeam
