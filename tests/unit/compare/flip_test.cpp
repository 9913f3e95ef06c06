#include "bake/compare/flip.h"

#include <gtest/gtest.h>

#include "bake/compare/false_color.h"
#include "sunbeam/core/color_space.h"

namespace sunbeam {
namespace {

template <class F>
Image image_of(int width, int height, F color) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.set(x, y, color(x, y));
  return image;
}

Image filled(const Rgb& color) {
  return image_of(6, 5, [&](int, int) { return color; });
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Ramps and stripes; in the test picture turned round at the right, flat blue below.
Rgb pattern(int x, int y) { return {x / 23.0, y / 15.0, (7 * x + 3 * y) % 10 / 9.0}; }
const Image kReference = image_of(24, 16, pattern);
const Image kTest = image_of(24, 16, [](int x, int y) {
  const Rgb same = pattern(x, y);
  return Rgb(x > 12 ? 1 - same.r : same.r, same.g, y < 8 ? same.b : 0.25);
});

TEST(Flip, OfAPictureFromItselfIsZero) {
  for (const double value : flip(kReference, kReference, kDefaultPixelsPerDegree)) EXPECT_EQ(value, 0);
}

TEST(Flip, IsSymmetricAndWithinItsRange) {
  const auto ab = flip(kTest, kReference, 30), ba = flip(kReference, kTest, 30);
  EXPECT_EQ(ab, ba);
  EXPECT_EQ(ab.size(), 24u * 16u);
  for (const double value : ab) {
    EXPECT_GE(value, 0);
    EXPECT_LE(value, 1);
  }
}

// Flat pictures have no features and are not changed by blurring: what remains is the remapped colour
// distance. Black and white are 100 apart in L* and nowhere else; green and blue define 1.
TEST(Flip, OfFlatPicturesFollowsTheColourFormula) {
  const auto flat = [](const Rgb& a, const Rgb& b) {
    const auto values = flip(filled(a), filled(b), kDefaultPixelsPerDegree);
    for (const double value : values) EXPECT_NEAR(value, values[0], 1e-9);
    return values[0];
  };
  EXPECT_NEAR(flat({0, 1, 0}, {0, 0, 1}), 1, 1e-9);
  // L*a*b* of the primaries under D65 with Hunt's factor L* / 100.
  const double green[] = {87.7347, -86.1827 * 0.877347, 83.1793 * 0.877347};
  const double blue[] = {32.2970, 79.1875 * 0.322970, -107.8602 * 0.322970};
  const double most = std::pow(green[0] - blue[0] + std::hypot(green[1] - blue[1], green[2] - blue[2]), 0.7);
  const double white = std::pow(100, 0.7);
  EXPECT_NEAR(flat(Rgb(1), Rgb(0)), 0.95 + 0.05 * (white - 0.4 * most) / (0.6 * most), 1e-5);
  EXPECT_GT(flat(Rgb(1), Rgb(0)), 0.95);
  // L* of 0.18 is 116 cbrt(0.18) - 16; the distance is below p_c.
  const double grey = std::pow(116 * std::cbrt(0.18) - 116 * std::cbrt(0.17), 0.7);
  EXPECT_NEAR(flat(Rgb(0.18F), Rgb(0.17F)), 0.95 * grey / (0.4 * most), 1e-5);
}

// Values of a direct evaluation of the paper's equations with two-dimensional filters, in another language.
TEST(Flip, AgreesWithTwoDimensionalFilters) {
  const auto near = flip(kTest, kReference, 67), far = flip(kTest, kReference, 20);
  EXPECT_NEAR(mean_of(near), 0.4945720372635445, 1e-5);
  EXPECT_NEAR(near[0], 0.011471027355685002, 1e-4);  // the slope of x^0.7 at 0 enlarges rounding to float
  EXPECT_NEAR(near[5 * 24 + 14], 0.38086141983819183, 1e-5);
  EXPECT_NEAR(near[12 * 24 + 20], 0.9330143356493134, 1e-5);
  EXPECT_NEAR(mean_of(far), 0.4876824032340182, 1e-5);
  EXPECT_NEAR(far[5 * 24 + 14], 0.388290584921631, 1e-5);
  EXPECT_NEAR(far[12 * 24 + 20], 0.9570061712353407, 1e-5);
}

// High pictures are filtered in bands, wide ones at once; FLIP does not tell columns from rows.
TEST(Flip, BandsOfRowsDoNotShow) {
  constexpr int kLong = 300, kShort = 11;
  const auto test = [](int x, int y) {
    return transform(pattern(x % 24, y % 16), [](double c) { return 1 - c; });
  };
  const auto reference = [](int x, int y) { return pattern((x * x) % 24, (3 * y) % 16); };
  const auto turned = [](auto color) { return [=](int x, int y) { return color(y, x); }; };
  for (const double pixels_per_degree : {20.0, 67.0, 300.0}) {
    const auto wide =
        flip(image_of(kLong, kShort, test), image_of(kLong, kShort, reference), pixels_per_degree);
    const auto high = flip(image_of(kShort, kLong, turned(test)), image_of(kShort, kLong, turned(reference)),
                           pixels_per_degree);
    for (std::size_t x = 0; x < kLong; ++x)
      for (std::size_t y = 0; y < kShort; ++y)
        ASSERT_NEAR(high[x * kShort + y], wide[y * kLong + x], 1e-6) << x << " " << y;
  }
}

TEST(Flip, NeedsNoMorePixelsThanOne) {
  const auto one = [](double grey) { return image_of(1, 1, [&](int, int) { return Rgb(grey); }); };
  EXPECT_NEAR(flip(one(1), one(0), 67)[0], flip(filled(Rgb(1)), filled(Rgb(0)), 67)[0], 1e-9);
}

// The finer the checks, the less an observer sees of them; grey of the same lightness differs little then.
TEST(Flip, FineChecksFadeWithDistance) {
  const Image checks = image_of(64, 64, [](int x, int y) { return Rgb((x + y) % 2 ? 0.6 : 0.4); });
  const Image grey = image_of(64, 64, [](int, int) { return Rgb(0.5); });
  EXPECT_LT(mean_of(flip(checks, grey, 100)), 0.5 * mean_of(flip(checks, grey, 5)));
}

TEST(Displayed, RaisesNegativeComponentsAndStaysBelowOne) {
  const Image image = displayed(filled({-0.5, 0.25, 100}));
  EXPECT_GE(image.get(0, 0).r, 0);
  EXPECT_LE(image.get(0, 0).b, 1);
  EXPECT_EQ(displayed(filled({0.125, 0.25, 0.5})).get(2, 3), Rgb(0.125, 0.25, 0.5));
}

// The palette (chunk PLTE: 4 bytes of size, then its name) gets lighter from black to pale yellow.
TEST(Magma, GrowsEvenlyLighter) {
  const std::string png = magma_png({0, 0.5, 1, -3, 7, 1}, 3, 2);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  const std::size_t at = png.find("PLTE");
  ASSERT_NE(at, std::string::npos);
  const auto byte = [&](int k) {
    return double(static_cast<unsigned char>(png[at + 4 + static_cast<std::size_t>(k)]));
  };
  const auto linear = [](double b) { return std::pow((b / 255 + 0.055) / 1.055, 2.4); };
  double above = -1;
  for (int k = 0; k < 256; ++k) {
    const double y = luminance({linear(byte(3 * k)), linear(byte(3 * k + 1)), linear(byte(3 * k + 2))},
                               ColorSpace::rec709);
    EXPECT_GE(y, above) << k;
    above = y;
  }
  EXPECT_EQ(byte(0), 0);
  EXPECT_EQ(byte(3 * 255), 252);
  EXPECT_EQ(byte(3 * 255 + 1), 253);
  EXPECT_GT(above, 0.9);
}

}  // namespace
}  // namespace sunbeam
