#include "bake/compare/difference.h"

#include <fmt/format.h>

#include <limits>
#include <vector>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

std::string to_text(const PixelWindow& w) {
  return fmt::format("({}, {}) to ({}, {}) of {} x {}", w.x0, w.y0, w.x1, w.y1, w.width, w.height);
}

PixelWindow window_of(const ExrImage& picture) {
  return picture.window.value_or(PixelWindow::whole(picture.mean.width, picture.mean.height));
}

// Sums of one channel over some pixels.
struct Sums {
  double difference = 0, variance = 0;

  Sums& operator+=(const Sums& other) {
    difference += other.difference;
    variance += other.variance;
    return *this;
  }
  double z() const { return difference == 0 ? 0 : difference / std::sqrt(variance); }
};

// One channel of a pixel or a block.
struct Value {
  Sums sums;
  bool is_tested = false;
};

Value pixel_value(const ExrImage& a, const ExrImage& b, std::size_t k) {
  const double x = a.mean.rgb[k], y = b.mean.rgb[k];
  const double rounding = std::numeric_limits<float>::epsilon() * std::max(std::abs(x), std::abs(y));
  const double sampling = double{a.variance.rgb[k]} + b.variance.rgb[k];
  const Sums sums = {x - y, sampling + square(rounding)};
  return {sums, sampling > square(rounding) || std::abs(sums.z()) > kZLimit};
}

void count(ZCount& z, const Sums& sums) {
  ++z.tested;
  if (std::abs(sums.z()) > kZLimit) ++z.beyond;
}

NoiseTest noise_test(const ExrImage& a, const ExrImage& b) {
  NoiseTest test;
  const int width = a.mean.width, height = a.mean.height;
  const int columns = (width + kBlockSize - 1) / kBlockSize, rows = (height + kBlockSize - 1) / kBlockSize;
  std::vector<Value> blocks(3 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  Sums total[3];
  std::size_t k = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int channel = 0; channel < 3; ++channel, ++k) {
        const Value pixel = pixel_value(a, b, k);
        total[channel] += pixel.sums;
        if (!pixel.is_tested) continue;
        count(test.pixels, pixel.sums);
        Value& block =
            blocks[static_cast<std::size_t>(3 * (y / kBlockSize * columns + x / kBlockSize) + channel)];
        block.sums += pixel.sums;
        block.is_tested = true;
      }
  for (const Value& block : blocks)
    if (block.is_tested) count(test.blocks, block.sums);
  const double pixels = static_cast<double>(width) * height;
  for (int channel = 0; channel < 3; ++channel) {
    test.bias_error[channel] = std::sqrt(total[channel].variance) / pixels;
    test.bias_z[channel] = total[channel].z();
  }
  return test;
}

}  // namespace

double expected_share_beyond() { return std::erfc(kZLimit / std::numbers::sqrt2); }

Difference difference(const ExrImage& test, const ExrImage& reference) {
  const Image &a = test.mean, &b = reference.mean;
  if (a.empty() || a.width != b.width || a.height != b.height)
    throw Error(fmt::format("the pictures have {} x {} and {} x {} pixels; allowed: one size", a.width,
                            a.height, b.width, b.height));
  if (window_of(test) != window_of(reference))
    throw Error(fmt::format("the pictures are the pixels {} and {}; allowed: one window",
                            to_text(window_of(test)), to_text(window_of(reference))));
  Difference result;
  double squares = 0, relative = 0;
  for (std::size_t k = 0; k < a.rgb.size(); ++k) {
    const double y = b.rgb[k], d = a.rgb[k] - y;
    const int channel = static_cast<int>(k % 3);
    result.bias[channel] += d;
    result.reference_mean[channel] += y;
    squares += d * d;
    relative += d * d / (y * y + kRelativeMseEpsilon);
  }
  const double values = static_cast<double>(a.rgb.size()), pixels = values / 3;
  result.rmse = std::sqrt(squares / values);
  result.rel_mse = relative / values;
  result.bias *= 1 / pixels;
  result.reference_mean *= 1 / pixels;
  if (!test.variance.empty() && !reference.variance.empty()) result.noise = noise_test(test, reference);
  return result;
}

}  // namespace sunbeam
