#include "bake/compare/difference.h"

#include <gtest/gtest.h>

#include "sunbeam/core/error.h"
#include "sunbeam/core/rng.h"
#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

Image filled(int width, int height, const Rgb& color) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.set(x, y, color);
  return image;
}

TEST(Difference, OfAPictureFromItselfIsZero) {
  const ExrImage image = {filled(3, 2, {1, 2, 3}), filled(3, 2, Rgb(0.1)), {}};
  const Difference d = difference(image, image);
  EXPECT_EQ(d.rmse, 0);
  EXPECT_EQ(d.rel_mse, 0);
  EXPECT_EQ(d.bias, Rgb());
  ASSERT_TRUE(d.noise);
  EXPECT_EQ(d.noise->pixels.tested, 18);
  EXPECT_EQ(d.noise->pixels.beyond, 0);
  EXPECT_EQ(d.noise->bias_z, Rgb());
}

// Differences 0.5, 0, 0 and 0, -1, 2 from 0.25, 1, 0 and 1, 2, 0.
TEST(Difference, ByHand) {
  ExrImage test = {Image(2, 1), {}, {}}, reference = test;
  reference.mean.set(0, 0, {0.25, 1, 0});
  reference.mean.set(1, 0, {1, 2, 0});
  test.mean.set(0, 0, {0.75, 1, 0});
  test.mean.set(1, 0, {1, 1, 2});
  const Difference d = difference(test, reference);
  EXPECT_DOUBLE_EQ(d.rmse, std::sqrt((0.25 + 1 + 4) / 6));
  EXPECT_DOUBLE_EQ(d.rel_mse, (0.25 / 0.0725 + 1 / 4.01 + 4 / 0.01) / 6);
  EXPECT_EQ(d.bias, Rgb(0.25, -0.5, 1));
  EXPECT_EQ(d.reference_mean, Rgb(0.625, 1.5, 0));
  EXPECT_FALSE(d.noise);
}

TEST(Difference, NoiseNeedsTheVarianceOfBoth) {
  const ExrImage without = {filled(2, 2, Rgb(1)), {}, {}},
                 with = {filled(2, 2, Rgb(1)), filled(2, 2, Rgb(1)), {}};
  EXPECT_FALSE(difference(with, without).noise);
  EXPECT_FALSE(difference(without, with).noise);
  EXPECT_TRUE(difference(with, with).noise);
}

// 13 x 1 pixels, hence a block of 10 and one of 3. The first pixel is 6 off at variance 1 + 3, three standard
// errors exactly; the last 6.5.
TEST(Difference, StandardErrorsByHand) {
  ExrImage test = {filled(13, 1, Rgb(1)), filled(13, 1, Rgb(1)), {}};
  const ExrImage reference = {filled(13, 1, Rgb(1)), filled(13, 1, Rgb(3)), {}};
  test.mean.set(0, 0, {7, 1, 1});
  test.mean.set(12, 0, {1, 7.5, 1});
  const NoiseTest noise = *difference(test, reference).noise;
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(noise.bias_error[channel], std::sqrt(13 * 4.0) / 13, 1e-12);
  EXPECT_NEAR(noise.bias_z.r, 6 / std::sqrt(13 * 4.0), 1e-12);
  EXPECT_NEAR(noise.bias_z.g, 6.5 / std::sqrt(13 * 4.0), 1e-12);
  EXPECT_EQ(noise.bias_z.b, 0);
  EXPECT_EQ(noise.pixels.tested, 39);
  EXPECT_EQ(noise.pixels.beyond, 1);
  EXPECT_EQ(noise.blocks.tested, 6);
  EXPECT_EQ(noise.blocks.beyond, 0);  // 6.5 / sqrt(3 * 4) = 1.9
}

TEST(Difference, ABiasThatPixelsHideShowsInBlocks) {
  ExrImage test = {filled(20, 20, Rgb(1.5)), filled(20, 20, Rgb(0.5)), {}};
  const ExrImage reference = {filled(20, 20, Rgb(1)), filled(20, 20, Rgb(0.5)), {}};
  NoiseTest noise = *difference(test, reference).noise;
  EXPECT_EQ(noise.pixels.beyond, 0);       // each 0.5 standard errors off
  EXPECT_EQ(noise.blocks.share(), 1);      // 0.5 * 100 / sqrt(100) = 5
  EXPECT_NEAR(noise.bias_z.r, 10, 1e-10);  // 0.5 * 400 / sqrt(400)
  test.mean = filled(20, 20, Rgb(1.25));
  noise = *difference(test, reference).noise;
  EXPECT_EQ(noise.blocks.beyond, 0);  // 2.5
  EXPECT_EQ(noise.blocks.tested, 12);
}

TEST(Difference, PixelsWithoutNoise) {
  ExrImage test = {filled(4, 1, Rgb(0.1)), Image(4, 1), {}};
  const ExrImage reference = test;
  test.mean.set(0, 0, Rgb(std::nextafter(0.1F, 1.0F)));  // rounding alone
  test.mean.set(1, 0, {0.1F, 0.2F, 0.1F});
  const NoiseTest noise = *difference(test, reference).noise;
  EXPECT_EQ(noise.pixels.tested, 1);
  EXPECT_EQ(noise.pixels.beyond, 1);
  EXPECT_EQ(noise.blocks.tested, 1);
  EXPECT_TRUE(is_finite(noise.bias_z));
}

// Two renderings of one truth with normal noise of known variance, 300 x 300: 270000 values, 2700 blocks,
// each beyond 3 sigma with probability 0.0027. Bounds at 5 standard deviations of the counts: false alarm
// 1e-6.
TEST(Difference, NormalNoiseIsBeyondAsOftenAsStated) {
  EXPECT_NEAR(expected_share_beyond(), 0.0026997960632602, 1e-15);
  constexpr int kSize = 300;
  ExrImage pictures[2];
  for (int k = 0; k < 2; ++k) {
    pictures[k] = {Image(kSize, kSize), filled(kSize, kSize, Rgb(k == 0 ? 0.01 : 0.03)), {}};
    Rng rng(7, static_cast<std::uint64_t>(k));
    for (float& value : pictures[k].mean.rgb) {
      const double radius = std::sqrt(-2 * std::log(1 - rng.uniform()));
      value = static_cast<float>(1 + std::sqrt(k == 0 ? 0.01 : 0.03) * radius *
                                         std::cos(2 * kPi * rng.uniform()));
    }
  }
  const NoiseTest noise = *difference(pictures[0], pictures[1]).noise;
  const double p = expected_share_beyond();
  EXPECT_EQ(noise.pixels.tested, 270000);
  EXPECT_EQ(noise.blocks.tested, 2700);
  EXPECT_NEAR(noise.pixels.share(), p, 5 * std::sqrt(p / 270000));
  EXPECT_NEAR(noise.blocks.share(), p, 5 * std::sqrt(p / 2700));
  for (int channel = 0; channel < 3; ++channel) EXPECT_LT(std::abs(noise.bias_z[channel]), 5);
}

// Two crops of one picture have a size in common and no pixel.
TEST(Difference, OfOtherWindowsIsRefused) {
  const auto refusal = [](const PixelWindow& a, const PixelWindow& b) {
    const ExrImage test{filled(8, 12, Rgb(1)), {}, {}, {}, a},
        reference{filled(8, 12, Rgb(1)), {}, {}, {}, b};
    return test::error_of([&] { difference(test, reference); });
  };
  const PixelWindow left{16, 12, 0, 0, 8, 12}, right{16, 12, 8, 0, 16, 12}, of_more{16, 24, 0, 0, 8, 12};
  EXPECT_EQ(refusal(left, left), "");
  EXPECT_EQ(
      refusal(left, right),
      "the pictures are the pixels (0, 0) to (8, 12) of 16 x 12 and (8, 0) to (16, 12) of 16 x 12; allowed: "
      "one window");
  EXPECT_NE(refusal(left, of_more), "");
  EXPECT_NE(refusal(left, PixelWindow::whole(8, 12)), "");
}

TEST(Difference, OfOtherSizesIsRefused) {
  const ExrImage a = {Image(3, 2), {}, {}}, b = {Image(2, 3), {}, {}};
  EXPECT_THROW(difference(a, b), Error);
  EXPECT_THROW(difference({}, {}), Error);
}

}  // namespace
}  // namespace sunbeam
