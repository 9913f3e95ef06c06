#include "runtime/tracer/image_io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <png.h>

#include "tests/render/support.h"

namespace sunbeam {
namespace {

Image numbered(int width, int height, float first) {
  Image image(width, height);
  for (float& value : image.rgb) value = first += 0.37F;
  return image;
}

TEST(Exr, RoundTripKeepsEveryBit) {
  const ScratchFolder folder;
  const ExrImage written{
      numbered(7, 5, -3), numbered(7, 5, 1e-9F), {{"recipe", "id 12"}, {"scene", "[camera]\n"}}};
  write_exr(folder.file("a.exr"), written);
  const ExrImage read = read_exr(folder.file("a.exr"));
  EXPECT_EQ(read.mean.width, 7);
  EXPECT_EQ(read.mean.height, 5);
  EXPECT_EQ(read.mean.rgb, written.mean.rgb);
  EXPECT_EQ(read.variance.rgb, written.variance.rgb);
  EXPECT_EQ(read.attributes.at("recipe"), "id 12");
  EXPECT_EQ(read.attributes.at("scene"), "[camera]\n");
  EXPECT_EQ(folder.names().size(), 1u);  // no temporary is left
}

TEST(Exr, WithoutVariance) {
  const ScratchFolder folder;
  write_exr(folder.file("a.exr"), {numbered(3, 2, 0), {}, {}});
  EXPECT_TRUE(read_exr(folder.file("a.exr")).variance.empty());
}

// Another program's file: half pixels in a data window away from the origin. Pixel (x, y) holds x, y,
// `third`.
void write_half_window(const std::string& path, const std::string& third_channel) {
  const int width = 4, height = 3;
  const Imath::V2i min(5, -2);
  std::vector<half> pixels;
  for (int i = 0; i < width * height; ++i)
    for (const int value : {i % width, i / width, 7}) pixels.emplace_back(static_cast<float>(value));
  Imf::Header header(Imath::Box2i({0, 0}, {9, 9}),
                     Imath::Box2i(min, min + Imath::V2i(width - 1, height - 1)));
  Imf::FrameBuffer buffer;
  int offset = 0;
  for (const std::string& name : {std::string("R"), std::string("G"), third_channel}) {
    header.channels().insert(name, Imf::Channel(Imf::HALF));
    half* base = pixels.data() + offset++ - 3 * (min.x + width * min.y);
    buffer.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(base), 3 * sizeof(half),
                                   3 * width * sizeof(half)));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(height);
}

TEST(Exr, ReadsHalfPixelsInAnyDataWindow) {
  const ScratchFolder folder;
  write_half_window(folder.file("a.exr"), "B");
  const Image image = read_exr(folder.file("a.exr")).mean;
  ASSERT_EQ(image.width, 4);
  ASSERT_EQ(image.height, 3);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(image.get(x, y), Rgb(static_cast<double>(x), static_cast<double>(y), 7.0));
}

TEST(Exr, MissingChannelsAreNamed) {
  const ScratchFolder folder;
  write_half_window(folder.file("a.exr"), "Z");
  const std::string message = error_of([&] { read_exr(folder.file("a.exr")); });
  EXPECT_NE(message.find("found channels G, R, Z; allowed: R, G and B"), std::string::npos) << message;
}

TEST(Exr, ErrorsNameTheFile) {
  const ScratchFolder folder;
  const auto expect_error = [](const std::string& message, const std::string& file, const std::string& what) {
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  const std::string missing = folder.file("missing.exr"),
                    garbage = folder.write("garbage.exr", "not an EXR file");
  const std::string nowhere = folder.file("no/such/folder.exr");
  expect_error(error_of([&] { read_exr(missing); }), missing, "cannot read");
  expect_error(error_of([&] { read_exr(garbage); }), garbage, "cannot read");
  expect_error(error_of([&] { write_exr(nowhere, {numbered(2, 2, 0), {}, {}}); }), nowhere, "cannot write");
  expect_error(error_of([&] { write_exr(missing, {}); }), missing, "0 x 0");
  expect_error(error_of([&] {
                 write_exr(missing, {numbered(2, 2, 0), numbered(2, 3, 0), {}});
               }),
               missing, "2 x 3");
  EXPECT_EQ(folder.names().size(), 1u);  // the garbage only
}

TEST(Exr, RefusesToWriteWhatIsNotFinite) {
  const ScratchFolder folder;
  const std::string path = folder.file("a.exr");
  Image broken = numbered(2, 2, 0);
  broken.set(1, 1, Rgb(1e300));
  EXPECT_EQ(error_of([&] {
              write_exr(path, {broken, {}, {}});
            }),
            path + ": cannot write the picture: R, G or B holds inf; allowed: finite numbers");
  EXPECT_NE(error_of([&] {
              write_exr(path, {numbered(2, 2, 0), broken, {}});
            }).find("the variance holds inf"),
            std::string::npos);
  const std::map<std::string, std::vector<float>> layers{{"depth", {0, 1, 2, std::nanf("")}}};
  EXPECT_NE(error_of([&] {
              write_exr(path, {numbered(2, 2, 0), {}, {}, layers});
            }).find("channel depth holds"),
            std::string::npos);
  EXPECT_NE(error_of([&] { write_png(path, broken); }).find("it holds inf"), std::string::npos);
  EXPECT_TRUE(folder.names().empty());
}

TEST(Exr, TruncatedFileIsAnErrorNotACrash) {
  const ScratchFolder folder;
  const std::string path = folder.file("a.exr");
  write_exr(path, {numbered(64, 64, 0), {}, {}});
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_NE(error_of([&] { read_exr(path); }).find(path), std::string::npos);
}

TEST(Png, HasSignatureSizeAndEightBitRgb) {
  const ScratchFolder folder;
  write_png(folder.file("a.png"), numbered(300, 5, 0));
  std::ifstream in(folder.file("a.png"), std::ios::binary);
  std::string head(29, '\0');
  in.read(head.data(), 29);
  ASSERT_TRUE(in);
  // Signature, IHDR, big-endian width 300 and height 5, 8 bits, colour type 2 (RGB).
  EXPECT_EQ(head.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(head.substr(16, 10), std::string("\0\0\x01\x2c\0\0\0\x05\x08\x02", 10));
  EXPECT_EQ(folder.names().size(), 1u);
}

// Rows of an 8-bit RGB file, by libpng.
std::vector<int> png_values(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str())) return {};
  png.format = PNG_FORMAT_RGB;
  std::vector<png_byte> bytes(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr)) return {};
  return {bytes.begin(), bytes.end()};
}

// The sRGB curve of IEC 61966-2-1: 0.2159 is the byte 128. Up to 0.5 the
// tone curve changes nothing.
TEST(Png, PixelsAreSrgbOfTheirValues) {
  const ScratchFolder folder;
  Image image(2, 2);
  image.set(0, 0, {0, 0.002, 0.02});
  image.set(1, 0, {0.05, 0.1, 0.18});
  image.set(0, 1, {0.2158605, 0.3, 0.4});
  image.set(1, 1, {0.5, 0.0031308, -1});
  write_png(folder.file("a.png"), image);
  EXPECT_EQ(png_values(folder.file("a.png")),
            (std::vector{0, 7, 39, 63, 89, 118, 128, 149, 170, 188, 10, 0}));
}

TEST(Exr, KeepsSignsAndNamesRec709) {
  const ScratchFolder folder;
  Image image(1, 1);
  image.set(0, 0, {-0.25, 0.5, 2});
  write_exr(folder.file("a.exr"), {image, {}, {}});
  EXPECT_EQ(read_exr(folder.file("a.exr")).mean.get(0, 0), Rgb(-0.25, 0.5, 2));
  Imf::InputFile file(folder.file("a.exr").c_str());
  ASSERT_TRUE(Imf::hasChromaticities(file.header()));
  const Imf::Chromaticities c = Imf::chromaticities(file.header());
  EXPECT_EQ(c.red, Imath::V2f(0.64F, 0.33F));
  EXPECT_EQ(c.green, Imath::V2f(0.30F, 0.60F));
  EXPECT_EQ(c.blue, Imath::V2f(0.15F, 0.06F));
  EXPECT_EQ(c.white, Imath::V2f(0.3127F, 0.3290F));
}

TEST(Png, CountsTheNegativeComponentsItRaises) {
  const ScratchFolder folder;
  Image image(2, 1);
  image.set(0, 0, {-0.25, 0.5, 0.5});
  image.set(1, 0, {0.5, 0.5, 0.5});
  const ClipAccount account = write_png(folder.file("a.png"), image);
  EXPECT_EQ(account.colors, 2);
  EXPECT_EQ(account.clipped, 1);
  EXPECT_EQ(account.lowest, -0.25);
  EXPECT_NEAR(account.luminance_added, 0.25 * 0.2126, 1e-4);
  EXPECT_EQ(write_png(folder.file("b.png"), numbered(3, 3, 0)).clipped, 0);
}

TEST(Png, ErrorsNameTheFile) {
  const ScratchFolder folder;
  const std::string path = folder.file("no/such/folder.png");
  EXPECT_NE(error_of([&] { write_png(path, Image(2, 2)); }).find(path), std::string::npos);
  EXPECT_NE(error_of([&] { write_png(path, {}); }).find("0 x 0"), std::string::npos);
}

TEST(DisplayColor, IsIdentityBelowTheKneeThenSmoothRisingAndBelowOne) {
  EXPECT_EQ(display_color({0.1, 0.2, 0.5}), Rgb(0.1, 0.2, 0.5));
  EXPECT_EQ(display_color({0, 0, 0}), Rgb());
  EXPECT_EQ(display_color({-1, -2, -0.1}), Rgb());
  EXPECT_NEAR(display_color(Rgb(0.5001)).r, 0.5001, 1e-6);
  double last = 0;
  for (double x = 0.05; x < 8; x *= 1.1) {
    const double shown = display_color(Rgb(x)).g;
    EXPECT_GT(shown, last);
    EXPECT_LT(shown, 1);
    last = shown;
  }
}

TEST(DisplayColor, BrightColoursKeepTheirOrderAndStaySaturated) {
  const Rgb shown = display_color({0.2, 1, 4});
  EXPECT_LT(shown.r, shown.g);
  EXPECT_LT(shown.g, shown.b);
  EXPECT_LT(shown.r, 0.3);  // not washed out to white
}

}  // namespace
}  // namespace sunbeam
