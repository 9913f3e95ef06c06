// EXR pictures as other programs write them, and as nobody should.
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfRgbaFile.h>

#include <limits>

#include "runtime/tracer/image_io.h"
#include "sunbeam/core/read_limit.h"
#include "tests/render/exr_files.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

ExrImage read(const std::vector<ExrPart>& parts) { return parse_exr(exr_file(parts), "a.exr"); }

std::string refusal(const std::string& bytes) {
  const std::string message = error_of([&] { parse_exr(bytes, "a.exr"); });
  EXPECT_TRUE(message.starts_with("a.exr: ")) << message;
  return message;
}

void expect_contains(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

// Values that halfs hold, and that tell where they stand.
ExrPart numbered_part(int width, int height) {
  return rgb_part(
      width, height, [](int x, int y) { return static_cast<float>(x + y); },
      [](int x, int) { return static_cast<float>(x); }, [](int, int y) { return static_cast<float>(y); });
}

void expect_numbered(const ExrImage& exr, int width, int height, double tolerance) {
  ASSERT_EQ(exr.mean.width, width);
  ASSERT_EQ(exr.mean.height, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb pixel = exr.mean.get(x, y);
      ASSERT_NEAR(pixel.r, x + y, tolerance);
      ASSERT_NEAR(pixel.g, x, tolerance);
      ASSERT_NEAR(pixel.b, y, tolerance);
    }
}

TEST(ExrPicture, EveryCompressionInScanLinesAndMipMappedTiles) {
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression)
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT, Imf::UINT})
      for (const bool is_tiled : {false, true}) {
        ExrPart part = numbered_part(37, 21);
        part.compression = static_cast<Imf::Compression>(compression);
        part.type = type;
        part.is_tiled = is_tiled;
        const bool is_dwa = compression >= Imf::DWAA_COMPRESSION;
        const bool is_lossy =
            is_dwa ? type != Imf::UINT : compression >= Imf::B44_COMPRESSION && type == Imf::HALF;
        SCOPED_TRACE(testing::Message() << compression << " " << type << " " << is_tiled);
        expect_numbered(read({part}), 37, 21, is_lossy ? 1.5 : 0);
      }
}

TEST(ExrPicture, LinesInDecreasingOrderAndAnyDataWindow) {
  ExrPart part = numbered_part(9, 5);
  part.corner = {-3, 1000};
  part.display = {{-10, 990}, {20, 1010}};
  part.edit = [](Imf::Header& header) {
    header.lineOrder() = Imf::DECREASING_Y;
    header.pixelAspectRatio() = 2;
  };
  const ExrImage exr = read({part});
  expect_numbered(exr, 9, 5, 0);
  EXPECT_EQ(*exr.window, (PixelWindow{31, 21, 7, 10, 16, 15}));
}

TEST(ExrPicture, TheFirstPartWithColoursIsRead) {
  ExrPart depth;
  depth.channels = {{"Z", constant(7)}, {"R", constant(8)}};
  ExrPart colors = numbered_part(6, 4), later = grey_part(2, 2, 9);
  for (ExrPart* part : {&depth, &colors, &later}) part->display = {{0, 0}, {5, 3}};
  const ExrImage exr = read({depth, colors, later});
  expect_numbered(exr, 6, 4, 0);
}

TEST(ExrPicture, LuminanceIsGrey) {
  ExrPart part;
  part.channels = {{"Y", [](int x, int y) { return static_cast<float>(x - y); }}, {"A", constant(0.5f)}};
  const Image image = read({part}).mean;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) EXPECT_EQ(image.get(x, y), Rgb(x - y));
}

TEST(ExrPicture, LuminanceAndChromaAreColours) {
  Imf::StdOSStream stream;
  const std::vector<Imf::Rgba> pixels(32 * 16, Imf::Rgba(0.5f, 0.25f, 0.125f, 1.0f));
  {
    Imf::RgbaOutputFile file(stream, Imf::Header(32, 16), Imf::WRITE_YC);
    file.setFrameBuffer(pixels.data(), 1, 32);
    file.writePixels(16);
  }
  const Image image = parse_exr(stream.str(), "a.exr").mean;
  ASSERT_EQ(image.width, 32);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x) {
      EXPECT_NEAR(image.get(x, y).r, 0.5, 5e-3);  // the writer rounds luminance to 7 bits
      EXPECT_NEAR(image.get(x, y).g, 0.25, 5e-3);
      EXPECT_NEAR(image.get(x, y).b, 0.125, 5e-3);
    }
}

void set_chromaticities(Imf::Header& header, const Imf::Chromaticities& c) {
  Imf::addChromaticities(header, c);
}

const Imf::Chromaticities kAp1({0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f});

TEST(ExrPicture, ChromaticitiesAreConvertedToRec709) {
  ExrPart part = rgb_part(3, 2, constant(0.25f), constant(0.1f), constant(0.025f));
  for (const char* name : {"variance.R", "variance.G", "variance.B"}) part.channels[name] = constant(1);
  part.edit = [](Imf::Header& header) { set_chromaticities(header, kAp1); };
  const ExrImage exr = read({part});
  EXPECT_NEAR(exr.mean.get(2, 1).r, 0.362, 5e-4);
  EXPECT_NEAR(exr.mean.get(2, 1).g, 0.081, 5e-4);
  EXPECT_NEAR(exr.mean.get(2, 1).b, 0.010, 5e-4);
  EXPECT_TRUE(exr.is_converted);
  EXPECT_TRUE(exr.variance.empty());
}

// AP0 has a primary below the axis, ProPhoto a white that is not D65.
TEST(ExrPicture, WhiteStaysWhite) {
  const Imf::Chromaticities ap0({0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f}, {0.32168f, 0.33767f});
  const Imf::Chromaticities prophoto({0.7347f, 0.2653f}, {0.1596f, 0.8404f}, {0.0366f, 0.0001f},
                                     {0.3457f, 0.3585f});
  for (const auto& space : {ap0, prophoto}) {
    ExrPart part = grey_part(2, 2, 0.75f);
    part.edit = [&](Imf::Header& header) { set_chromaticities(header, space); };
    const Rgb pixel = read({part}).mean.get(1, 1);
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(pixel[channel], 0.75, 1e-5);
  }
}

// Programs that write X, Y and Z as R, G and B state the white (1/3, 1/3), and mean no adaptation: the values
// of D65 are white in Rec.709.
TEST(ExrPicture, TristimulusValuesAreNotAdapted) {
  ExrPart part = rgb_part(2, 2, constant(0.9505f), constant(1), constant(1.0891f));
  part.edit = [](Imf::Header& header) {
    set_chromaticities(header, {{1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f}});
  };
  const Rgb pixel = read({part}).mean.get(1, 1);
  for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(pixel[channel], 1, 1e-3);
}

TEST(ExrPicture, ChromaticitiesThatMakeNoSpaceAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Imf::Chromaticities on_a_line({0.1f, 0.1f}, {0.2f, 0.2f}, {0.3f, 0.3f}, {0.3127f, 0.329f});
  const Imf::Chromaticities no_number({nan, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3127f, 0.329f});
  const Imf::Chromaticities no_white({0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0, 0});
  const Imf::Chromaticities white_outside({0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.7f, 0.3f});
  for (const auto& space : {on_a_line, no_number, no_white, white_outside}) {
    ExrPart part = grey_part(2, 2, 1);
    part.edit = [&](Imf::Header& header) { set_chromaticities(header, space); };
    expect_contains(refusal(exr_file({part})), "chromaticities");
  }
}

TEST(ExrPicture, LayersAreNamedUpToTen) {
  ExrPart part;
  for (char layer = 'a'; layer < 'm'; ++layer) part.channels[std::string(1, layer) + ".R"] = constant(1);
  const std::string message = refusal(exr_file({part}));
  expect_contains(
      message,
      "found channels a.R, b.R, c.R, d.R, e.R, f.R, g.R, h.R, i.R, j.R and 2 more; allowed: R, G and B");
}

TEST(ExrPicture, ValuesThatAreNotFiniteAreNamedWithTheirPixel) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    ExrPart part = rgb_part(
        5, 4, constant(1), [=](int x, int y) { return x == 3 && y == 2 ? bad : 1; }, constant(1));
    expect_contains(refusal(exr_file({part})), "channel G of pixel (3, 2) from the top left");
  }
  // A float of one space can be none of the other.
  ExrPart part = rgb_part(1, 1, constant(3e38f), constant(0), constant(0));
  part.edit = [](Imf::Header& header) { set_chromaticities(header, kAp1); };
  expect_contains(refusal(exr_file({part})), "channel R of pixel (0, 0)");
}

TEST(ExrPicture, DeepDataIsRefusedByName) {
  Imf::StdOSStream stream;
  Imf::Header header(2, 2);
  for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  const unsigned counts[4] = {};
  float* samples[4] = {};
  {
    Imf::DeepScanLineOutputFile file(stream, header);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT,
                                             reinterpret_cast<char*>(const_cast<unsigned*>(counts)),
                                             sizeof(unsigned), 2 * sizeof(unsigned)));
    for (const char* name : {"R", "G", "B"})
      buffer.insert(name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples), sizeof(float*),
                                         2 * sizeof(float*), sizeof(float)));
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  expect_contains(refusal(stream.str()), "deep");
}

TEST(ExrPicture, HeadersThatClaimTooMuchAreRefused) {
  const std::string bytes = exr_file({grey_part(4, 3, 1)});
  expect_contains(refusal(with_most_rows(bytes, "dataWindow")), "data windows ask for");
  expect_contains(refusal(with_rows(bytes, "dataWindow", 0, 500000000)), "data windows ask for");
  expect_contains(refusal(with_rows(bytes, "dataWindow", 0, 2147483643)), "dataWindow");
  for (std::size_t size = 0; size < bytes.size(); ++size) refusal(bytes.substr(0, size));
}

// An environment has a distribution beside its pixels, a comparison the map of FLIP.
TEST(ExrPicture, MemoryOfTheCallerCounts) {
  ExrPart grey;
  grey.channels = {{"Y", constant(1)}};
  for (const ExrPart& part : {grey_part(4, 3, 1), grey}) {
    const std::string bytes = exr_file({part});
    const std::uint64_t limit = read_limit(bytes.size());
    EXPECT_EQ(parse_exr(bytes, "a.exr", ExrChannels::mean, limit / 12 - 16).mean.width, 4);
    const std::string message = error_of([&] { parse_exr(bytes, "a.exr", ExrChannels::mean, limit / 12); });
    expect_contains(message, "a.exr: the picture of 4 x 3 pixels asks for");
  }
}

// What is not asked for takes no memory.
TEST(ExrPicture, OtherLayersAreLeftOutUnlessWanted) {
  ExrPart part = grey_part(2, 2, 1);
  for (const char* name : {"variance.R", "variance.G", "variance.B", "Z"}) part.channels[name] = constant(2);
  const std::string bytes = exr_file({part});
  const ExrImage all = parse_exr(bytes, "a.exr");
  EXPECT_EQ(all.layers.size(), 1u);
  EXPECT_FALSE(all.variance.empty());
  const ExrImage noise = parse_exr(bytes, "a.exr", ExrChannels::mean_and_variance);
  EXPECT_TRUE(noise.layers.empty());
  EXPECT_FALSE(noise.variance.empty());
  EXPECT_TRUE(parse_exr(bytes, "a.exr", ExrChannels::mean).variance.empty());
}

}  // namespace
}  // namespace sunbeam
