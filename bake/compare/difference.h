// This file measures how far one rendered picture (the test) is from another (the reference), and whether
// noise explains it.
//
// Everything is measured on linear Rec.709 values, channels apart; sums run over pixels and channels.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "runtime/tracer/image_io.h"

namespace sunbeam {

// This is added to the squared reference in the relative error, so that black pixels do not divide by zero.
inline constexpr double kRelativeMseEpsilon = 0.01;
inline constexpr double kZLimit = 3;                // standard errors
inline constexpr int kBlockSize = 10;               // pixels on a side
inline constexpr double kZ95 = 1.9599639845400545;  // half-width of a 95 % interval, in standard errors

// Returns the share of values of a normal distribution beyond kZLimit standard deviations on either side:
// 0.0027.
double expected_share_beyond();

// Counts how many of the values that have noise differ by more than kZLimit standard errors.
struct ZCount {
  std::int64_t tested = 0, beyond = 0;
  double share() const { return tested > 0 ? static_cast<double>(beyond) / static_cast<double>(tested) : 0; }
};

// Says whether noise explains the difference, from the variance of both pictures. A value is one channel of a
// pixel or, for blocks, of the mean over kBlockSize x kBlockSize pixels (fewer at the right and lower edges).
// Its z is the difference over the root of the summed variances, to which the rounding of both values to
// float is added. Pixels that agree and have no noise in either picture, such as a constant background, are
// not tested. The mean of a block is nearly normal; a single pixel of few samples is not, and more than the
// normal share of them can lie beyond.
struct NoiseTest {
  Rgb bias_error;  // standard error of the bias
  Rgb bias_z;      // bias / bias_error; 0 where both are 0
  ZCount pixels, blocks;
};

struct Difference {
  double rmse = 0;                 // root of the mean of (A - B)^2
  double rel_mse = 0;              // mean of (A - B)^2 / (B^2 + kRelativeMseEpsilon)
  Rgb bias;                        // mean of A - B
  Rgb reference_mean;              // mean of B
  std::optional<NoiseTest> noise;  // if both pictures have variance
};

// Measures the difference of two pictures, whose values must be as read_rendering() allows them. Throws Error
// unless both have one size, that of at least one pixel, and one place in the whole picture.
Difference difference(const ExrImage& test, const ExrImage& reference);

}  // namespace sunbeam
