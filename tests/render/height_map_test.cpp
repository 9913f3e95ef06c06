// Height maps: the surface between the pixels, and the files they come from.
#include "runtime/tracer/height_map.h"

#include <gtest/gtest.h>

#include <limits>

#include "runtime/tracer/image_io.h"
#include "sunbeam/detail/file.h"
#include "tests/render/exr_files.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

HeightMap random_map(int width, int height) {
  HeightMap map{width, height, {}};
  Rng rng(8, 0);
  for (int i = 0; i < width * height; ++i) map.values.push_back(static_cast<float>(rng.uniform()));
  return map;
}

TEST(HeightMap, GradientIsThatOfTheHeight) {
  const HeightMap map = random_map(7, 5);
  constexpr double kStep = 1e-6;
  Rng rng(9, 0);
  for (int i = 0; i < 500; ++i) {
    const double u = rng.uniform(), v = rng.uniform();
    const auto height = [&](double du, double dv) { return map.sample({u + du, v + dv}).height; };
    const Point2 gradient = map.sample({u, v}).gradient;
    EXPECT_NEAR(gradient.x, (height(kStep, 0) - height(-kStep, 0)) / (2 * kStep), 1e-7);
    EXPECT_NEAR(gradient.y, (height(0, kStep) - height(0, -kStep)) / (2 * kStep), 1e-7);
  }
}

TEST(HeightMap, RepeatsExactly) {
  const HeightMap map = random_map(4, 3);
  for (const double u : {0.0, 0.125, 0.8125})
    for (const double v : {0.0, 0.375, 0.9375}) {
      const auto here = map.sample({u, v});
      for (const Point2& there : {Point2{u + 1, v}, Point2{u - 3, v + 2}, Point2{u, v - 1}}) {
        EXPECT_EQ(map.sample(there).height, here.height);
        EXPECT_EQ(map.sample(there).gradient.x, here.gradient.x);
        EXPECT_EQ(map.sample(there).gradient.y, here.gradient.y);
      }
    }
}

TEST(HeightMap, FirstRowIsTheTopAndFirstColumnTheLeft) {
  HeightMap map{8, 8, std::vector<float>(64)};
  map.values[0] = 1;
  const double peak = map.sample({0.5 / 8, 7.5 / 8}).height;
  EXPECT_NEAR(peak, 4.0 / 9, 1e-12);  // (2/3)^2, the middle of the bicubic B-spline
  EXPECT_EQ(map.sample({0.5, 0.5}).height, 0);
}

TEST(HeightMap, AWaveKeepsItsShape) {
  // A cubic B-spline with the samples of cos(k x) as control points is cos(k x) (2 + cos(k h)) / 3 up to the
  // 4th order of the step h.
  constexpr int kWidth = 64;
  HeightMap map{kWidth, 1, {}};
  for (int i = 0; i < kWidth; ++i)
    map.values.push_back(static_cast<float>(std::cos(2 * kPi * (i + 0.5) / kWidth)));
  const double factor = (2 + std::cos(2 * kPi / kWidth)) / 3;
  for (double u = 0; u < 1; u += 0.01) {
    EXPECT_NEAR(map.sample({u, 0.3}).height, factor * std::cos(2 * kPi * u), 1e-6);
    EXPECT_NEAR(map.sample({u, 0.3}).gradient.x, -factor * 2 * kPi * std::sin(2 * kPi * u), 1e-4);
  }
}

TEST(HeightMap, FilesRoundTrip) {
  const ScratchFolder folder;
  const HeightMap map = random_map(9, 6);
  for (const auto& [name, tolerance] : {std::pair{"a.exr", 0.0}, std::pair{"a.png", 0.51 / 65535}}) {
    write_height_map(folder.file(name), map);
    const HeightMap read = load_height_map(folder.file(name));
    ASSERT_EQ(read.width, map.width);
    ASSERT_EQ(read.height, map.height);
    for (std::size_t i = 0; i < map.values.size(); ++i)
      ASSERT_NEAR(read.values[i], map.values[i], tolerance) << name;
  }
  EXPECT_EQ(folder.names().size(), 2u);  // no temporary is left
}

TEST(HeightMap, ReadsPicturesOfThreeChannelsAndEightBits) {
  const ScratchFolder folder;
  Image image(2, 1);
  image.set(0, 0, Rgb(0.25));
  image.set(1, 0, Rgb(1000));
  write_exr(folder.file("a.exr"), {image, {}, {}});
  EXPECT_EQ(load_height_map(folder.file("a.exr")).values, (std::vector<float>{0.25f, 1000.0f}));
  write_png(folder.file("a.png"), image);
  const HeightMap bytes = load_height_map(folder.file("a.png"));
  EXPECT_FLOAT_EQ(bytes.values[0], 137.0f / 255);  // the sRGB byte of 0.25, taken as it stands
  EXPECT_FLOAT_EQ(bytes.values[1], 1);
}

HeightMap heights(const ExrPart& part) { return parse_height_map(exr_file({part}), "a.exr"); }

TEST(HeightMap, ChannelYOrRInTheDisplayWindow) {
  ExrPart part;
  part.channels = {{"Y", [](int x, int y) { return static_cast<float>(1 + x + 10 * y); }},
                   {"R", constant(7)}};
  EXPECT_EQ(heights(part).at(2, 1), 13);
  part.corner = {1, 1};
  part.display = {{0, 0}, {5, 2}};
  const HeightMap map = heights(part);
  ASSERT_EQ(map.width, 6);
  ASSERT_EQ(map.height, 3);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 6; ++x) {
      const bool is_inside = x >= 1 && x < 5 && y >= 1;
      EXPECT_EQ(map.at(x, y), static_cast<float>(is_inside ? 1 + (x - 1) + 10 * (y - 1) : 0))
          << x << " " << y;
    }
}

// No chromaticities, no envmap: heights are numbers.
TEST(HeightMap, WhatAnExrSaysAboutColoursDoesNotMatter) {
  ExrPart part = rgb_part(2, 2, constant(0.5f), constant(9), constant(9));
  part.type = Imf::HALF;
  part.edit = [](Imf::Header& header) {
    Imf::addChromaticities(header, {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.3f, 0.3f}});
    Imf::addWhiteLuminance(header, 100);
  };
  EXPECT_EQ(heights(part).values, std::vector<float>(4, 0.5f));
}

// 16384 x 16384 floats are 1.07 GB, from a file of a few kB.
TEST(HeightMap, HeadersThatClaimTooMuchAreRefused) {
  ExrPart part;
  part.width = 16384;
  part.channels = {{"Y", constant(0)}};
  const std::string bytes = exr_file({part});
  for (const std::string& hostile :
       {with_rows(bytes, "dataWindow", 0, 16383), with_most_rows(bytes, "dataWindow")}) {
    const std::string message = error_of([&] { parse_height_map(hostile, "a.exr"); });
    EXPECT_NE(message.find("data windows ask for"), std::string::npos) << message;
  }
  part.display = {{0, 0}, {16383, 16383}};
  const std::string message = error_of([&] { heights(part); });
  EXPECT_NE(message.find("of memory; allowed for a file of this size"), std::string::npos) << message;
}

TEST(HeightMap, BadFilesAreRefused) {
  const ScratchFolder folder;
  const auto error = [&](const std::string& name) {
    const std::string message = error_of([&] { load_height_map(folder.file(name)); });
    EXPECT_NE(message.find(name), std::string::npos) << message;
    return message;
  };
  HeightMap map = random_map(3, 3);
  write_height_map(folder.file("whole.png"), map);
  map.values[4] = std::numeric_limits<float>::quiet_NaN();
  write_height_map(folder.file("nan.exr"), map);
  EXPECT_NE(error("nan.exr").find("holds the height nan"), std::string::npos);
  const std::string bytes = read_file(folder.file("whole.png"));
  folder.write("cut.png", bytes.substr(0, bytes.size() / 2));
  EXPECT_NE(error("cut.png"), "");
  folder.write("letters.exr", "no picture");
  EXPECT_NE(error("letters.exr"), "");
  EXPECT_NE(error("missing.png").find("No such file"), std::string::npos);
  EXPECT_NE(error("heights.jpg").find("allowed for heights: .exr, .png"), std::string::npos);
}

}  // namespace
}  // namespace sunbeam
