// Radiance pictures: scan lines of every coding and orientation, and what their headers say.
#include "runtime/tracer/radiance_hdr.h"

#include "tests/render/support.h"

namespace sunbeam {
namespace {

const std::string kMagic = "#?RADIANCE\n", kFormat = "FORMAT=32-bit_rle_rgbe\n";

// The exponent 136 makes the three bytes the values.
std::string pixel(int r, int g, int b, int e = 136) {
  return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}

std::string file_of(const std::string& size, const std::string& pixels,
                    const std::string& variables = kFormat) {
  return kMagic + variables + "\n" + size + "\n" + pixels;
}

Image read(const std::string& bytes) { return parse_radiance_hdr(bytes, "a.hdr", 0); }

std::string refusal(const std::string& bytes) {
  const std::string message = error_of([&] { read(bytes); });
  EXPECT_TRUE(message.starts_with("a.hdr: ")) << message;
  return message;
}

TEST(RadianceHdr, FlatPixels) {
  const Image image = read(file_of("-Y 2 +X 2", pixel(128, 64, 32, 129) + pixel(255, 0, 1) +
                                                    pixel(9, 9, 9, 0) + pixel(128, 128, 128, 255)));
  ASSERT_EQ(image.width, 2);
  ASSERT_EQ(image.height, 2);
  EXPECT_EQ(image.get(0, 0), Rgb(1, 0.5, 0.25));
  EXPECT_EQ(image.get(1, 0), Rgb(255, 0, 1));
  EXPECT_EQ(image.get(0, 1), Rgb());
  EXPECT_EQ(image.get(1, 1), Rgb(0x1p126));
}

TEST(RadianceHdr, EveryOrientation) {
  // Pixels of the file are numbered as they come; the picture has 3 columns and 2 rows.
  std::string pixels;
  for (int k = 0; k < 6; ++k) pixels += pixel(200, k, 0);
  const auto number_at = [&](const std::string& size, int x, int y) {
    const Image image = read(file_of(size, pixels));
    EXPECT_EQ(image.width, 3) << size;
    EXPECT_EQ(image.height, 2) << size;
    return image.get(x, y).g;
  };
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      EXPECT_EQ(number_at("-Y 2 +X 3", x, y), 3 * y + x);
      EXPECT_EQ(number_at("-Y 2 -X 3", x, y), 3 * y + 2 - x);
      EXPECT_EQ(number_at("+Y 2 +X 3", x, y), 3 * (1 - y) + x);
      EXPECT_EQ(number_at("+Y 2 -X 3", x, y), 3 * (1 - y) + 2 - x);
      EXPECT_EQ(number_at("+X 3 -Y 2", x, y), 2 * x + y);
      EXPECT_EQ(number_at("-X 3 -Y 2", x, y), 2 * (2 - x) + y);
      EXPECT_EQ(number_at("+X 3 +Y 2", x, y), 2 * x + 1 - y);
      EXPECT_EQ(number_at("-X 3 +Y 2", x, y), 2 * (2 - x) + 1 - y);
    }
}

TEST(RadianceHdr, OldRuns) {
  // One pixel, three more of it, one, then 256 + 2 of that.
  const std::string runs =
      pixel(200, 1, 0) + pixel(1, 1, 1, 3) + pixel(200, 2, 0) + pixel(1, 1, 1, 2) + pixel(1, 1, 1, 1);
  const Image image = read(file_of("-Y 1 +X 263", runs));
  for (int x = 0; x < 263; ++x) EXPECT_EQ(image.get(x, 0), Rgb(200, x < 4 ? 1 : 2, 0)) << x;
}

TEST(RadianceHdr, NewRunsBesideFlatLines) {
  const std::string components = std::string("\x88\x07", 2) +                  // red: 8 of 7
                                 std::string("\x03\x01\x02\x03\x85\x09", 6) +  // green: 1, 2, 3, five of 9
                                 std::string("\x08\0\x01\x02\x03\x04\x05\x06\x07", 9) +  // blue: 0 to 7
                                 std::string("\x88\x88", 2);                             // exponents
  std::string flat;
  for (int x = 0; x < 8; ++x) flat += pixel(200, x, 1);
  const Image image = read(file_of("-Y 2 +X 8", std::string("\x02\x02\0\x08", 4) + components + flat));
  for (int x = 0; x < 8; ++x) {
    EXPECT_EQ(image.get(x, 0), Rgb(7, x < 3 ? x + 1 : 9, x));
    EXPECT_EQ(image.get(x, 1), Rgb(200, x, 1));
  }
}

TEST(RadianceHdr, FactorsOfTheHeaderAreDividedOut) {
  const std::string variables = "# a comment = 3\nSOFTWARE=x\n\tpcomb -s 2\nEXPOSURE= 2.0\n" + kFormat +
                                "EXPOSURE=5\nCOLORCORR= 1 2 4\nGAMMA=1\nVIEW= -vtv\n";
  const Image image = read(file_of("-Y 1 +X 1", pixel(200, 200, 200), variables));
  EXPECT_EQ(image.get(0, 0), Rgb(20, 10, 5));
}

TEST(RadianceHdr, LinesMayEndAsOnWindows) {
  EXPECT_EQ(read("#?RGBE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n" + pixel(1, 2, 3)).get(0, 0),
            Rgb(1, 2, 3));
}

TEST(RadianceHdr, PrimariesAreConverted) {
  const auto color = [](const std::string& primaries) {
    return read(file_of("-Y 1 +X 1", pixel(250, 100, 25), kFormat + "PRIMARIES=" + primaries + "\n"))
        .get(0, 0);
  };
  EXPECT_EQ(color("0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290"), Rgb(250, 100, 25));
  const Rgb ap1 = color(" 0.713 0.293 0.165 0.830 0.128 0.044 0.32168 0.33767");
  EXPECT_NEAR(ap1.r, 362, 0.5);
  EXPECT_NEAR(ap1.g, 81, 0.5);
  EXPECT_NEAR(ap1.b, 10, 0.5);
}

TEST(RadianceHdr, BadHeadersAreNamed) {
  const auto expect = [](const std::string& variables, const std::string& size, const std::string& part) {
    const std::string message = refusal(file_of(size, pixel(1, 2, 3), variables));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  const std::string size = "-Y 1 +X 1";
  expect("FORMAT=32-bit_rle_xyze\n", size, "FORMAT is '32-bit_rle_xyze'; allowed: 32-bit_rle_rgbe");
  expect("EXPOSURE=0\n", size, "EXPOSURE makes a factor of 0");
  expect("EXPOSURE=nan\n", size, "EXPOSURE is 'nan'; allowed: 1 numbers");
  expect("EXPOSURE=-1\n", size, "EXPOSURE");
  expect("EXPOSURE=1e20\nEXPOSURE=1e20\n", size, "EXPOSURE");
  expect("COLORCORR=1 2\n", size, "COLORCORR is '1 2'; allowed: 3 numbers");
  expect("GAMMA=2.2\n", size, "GAMMA is '2.2'; allowed: 1");
  expect("PRIMARIES=0 0 0 0 0 0 0 0\n", size, "chromaticities");
  for (const char* bad : {"", "-Y 1", "-Y 0 +X 1", "-Y 1 -Y 1", "-Y 1 +X -1", "-Y 1 +X 1 1", "-Y a +X 1",
                          "Y 1 X 1", "-Y 99999999999 +X 1"})
    expect(kFormat, bad, "the size is '");
  expect(kFormat, "-Y 2147483647 +X 2147483647", "of memory; allowed for a file of this size");
  EXPECT_NE(refusal("#?RADIANCE\nFORMAT=32-bit_rle_rgbe").find("the header has no end"), std::string::npos);
}

TEST(RadianceHdr, BrokenScanLinesAreRefused) {
  const auto expect = [](int width, const std::string& pixels, const std::string& part) {
    const std::string message = refusal(file_of("-Y 1 +X " + std::to_string(width), pixels));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  const std::string start("\x02\x02\0\x08", 4);
  expect(8, start, "ends early");
  expect(8, start + "\x89\x01", "passes the end");
  expect(8, start + std::string("\0\x01", 2), "passes the end");
  expect(8, start + "\x09", "passes the end");
  expect(9, start, "another length");
  expect(4, pixel(1, 1, 1, 3), "repeats no pixel");
  expect(4, pixel(9, 9, 9) + pixel(1, 1, 1, 4), "passes the end");
  expect(4, pixel(9, 9, 9), "ends early");
  std::string endless = pixel(9, 9, 9);
  for (int k = 0; k < 10; ++k) endless += pixel(1, 1, 1, 0);
  expect(4, endless, "repeats no pixel");
}

}  // namespace
}  // namespace sunbeam
