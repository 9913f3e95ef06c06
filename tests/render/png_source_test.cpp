// PNG files: heights and fields are the numbers that are stored.
#include "runtime/tracer/png_source.h"

#include "runtime/tracer/height_map.h"
#include "tests/render/png_files.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

using Edit = std::function<void(png_structp, png_infop)>;

HeightMap heights(const PngFile& file) { return parse_height_map(file.bytes(), "a.png"); }

std::string refusal(const std::string& bytes) {
  const std::string message = error_of([&] { parse_height_map(bytes, "a.png"); });
  EXPECT_TRUE(message.starts_with("a.png: ")) << message;
  return message;
}

const std::vector<Edit> kColorChunks = {
    [](png_structp, png_infop) {},
    [](png_structp png, png_infop info) { png_set_gAMA(png, info, 1.0); },
    [](png_structp png, png_infop info) { png_set_gAMA(png, info, 0.45455); },
    [](png_structp png, png_infop info) { png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL); },
    [](png_structp png, png_infop info) { png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_ABSOLUTE); },
    [](png_structp png, png_infop info) {
      png_set_cHRM(png, info, 0.3127, 0.329, 0.7, 0.3, 0.2, 0.7, 0.14, 0.05);
    },
};

TEST(PngHeights, AreTheStoredNumbersWhateverTheColoursSay) {
  for (const Edit& edit : kColorChunks) {
    PngFile wide = even_png(16, PNG_COLOR_TYPE_GRAY, {0x80, 0x01}),
            narrow = even_png(8, PNG_COLOR_TYPE_GRAY, {128});
    wide.edit = narrow.edit = edit;
    for (const float value : heights(wide).values) EXPECT_EQ(value, 32769.0f / 65535);
    for (const float value : heights(narrow).values) EXPECT_EQ(value, 128.0f / 255);
  }
}

TEST(PngHeights, EveryKindOfGrey) {
  const auto all = [](const PngFile& file, float value) {
    const HeightMap map = heights(file);
    ASSERT_EQ(map.width, file.width);
    ASSERT_EQ(map.height, file.height);
    for (const float v : map.values) EXPECT_EQ(v, value);
  };
  // A row of packed bits is one byte here.
  for (const auto& [bits, byte, value] :
       {std::tuple{1, 0xff, 1.0f}, {2, 0x55, 1 / 3.0f}, {4, 0x99, 9 / 15.0f}}) {
    PngFile file{.width = 2, .height = 2, .bits = bits, .rows = {}};
    file.rows.assign(2, {static_cast<png_byte>(byte)});
    all(file, value);
  }
  all(even_png(8, PNG_COLOR_TYPE_GRAY_ALPHA, {51, 3}), 0.2f);
  all(even_png(16, PNG_COLOR_TYPE_GRAY_ALPHA, {0x12, 0x34, 0, 1}), 0x1234 / 65535.0f);
  all(even_png(8, PNG_COLOR_TYPE_RGB, {51, 51, 51}), 0.2f);
  all(even_png(16, PNG_COLOR_TYPE_RGB, {1, 2, 1, 2, 1, 2}), 0x102 / 65535.0f);
  all(even_png(8, PNG_COLOR_TYPE_RGB_ALPHA, {51, 51, 51, 0}), 0.2f);
  PngFile transparent = even_png(8, PNG_COLOR_TYPE_GRAY, {51});
  transparent.edit = [](png_structp png, png_infop info) {
    png_color_16 grey{};
    grey.gray = 51;
    png_set_tRNS(png, info, nullptr, 0, &grey);
  };
  all(transparent, 0.2f);
  PngFile palette = even_png(8, PNG_COLOR_TYPE_PALETTE, {1});
  palette.edit = [](png_structp png, png_infop info) {
    const png_color colors[2] = {{1, 2, 3}, {51, 51, 51}};
    png_set_PLTE(png, info, colors, 2);
    const png_byte alpha[2] = {255, 7};
    png_set_tRNS(png, info, alpha, 2, nullptr);
  };
  all(palette, 0.2f);
}

TEST(PngHeights, InterlacedRowsStandWhereTheyBelong) {
  for (const bool is_interlaced : {false, true}) {
    PngFile file{.width = 13, .height = 11, .is_interlaced = is_interlaced, .rows = {}};
    for (int y = 0; y < 11; ++y) {
      file.rows.emplace_back();
      for (int x = 0; x < 13; ++x) file.rows.back().push_back(static_cast<png_byte>(x + 16 * y));
    }
    const HeightMap map = heights(file);
    for (int y = 0; y < 11; ++y)
      for (int x = 0; x < 13; ++x) EXPECT_EQ(map.at(x, y), static_cast<float>(x + 16 * y) / 255);
  }
}

TEST(PngHeights, ColoursAreRefusedWithTheirPixel) {
  PngFile file = even_png(8, PNG_COLOR_TYPE_RGB, {9, 9, 9});
  file.rows[2][4] = 8;
  const std::string message = refusal(file.bytes());
  EXPECT_NE(message.find("pixel (1, 2) from the top left has R, G, B 9, 8, 9; allowed"), std::string::npos)
      << message;
}

TEST(PngHeights, BrokenFilesAreRefused) {
  const std::string whole = even_png(8, PNG_COLOR_TYPE_GRAY, {9}, 40, 30).bytes();
  const std::size_t data = whole.find("IDAT") + 4;
  for (std::size_t size = 0; size < data + 8; ++size) refusal(whole.substr(0, size));
  for (std::size_t at = 0; at < data; ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x40);
    refusal(damaged);
  }
}

// The checksums of PNG are those of zlib.
std::string claim_size(std::string bytes, unsigned width, unsigned height) {
  unsigned crc = ~0u;
  for (int k = 0; k < 4; ++k) {
    bytes[16 + static_cast<std::size_t>(k)] = static_cast<char>(width >> (24 - 8 * k));
    bytes[20 + static_cast<std::size_t>(k)] = static_cast<char>(height >> (24 - 8 * k));
  }
  for (std::size_t at = 12; at < 29; ++at) {
    crc ^= static_cast<unsigned char>(bytes[at]);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  for (int k = 0; k < 4; ++k)
    bytes[29 + static_cast<std::size_t>(k)] = static_cast<char>(~crc >> (24 - 8 * k));
  return bytes;
}

TEST(PngHeights, HeadersThatClaimTooMuchAreRefused) {
  const std::string whole = even_png(8, PNG_COLOR_TYPE_GRAY, {9}).bytes();
  for (const auto& [width, height] : {std::pair{0x7fffffffu, 1u}, {1u, 0x7fffffffu}, {30000u, 30000u}}) {
    const std::string message = refusal(claim_size(whole, width, height));
    EXPECT_NE(message.find("of memory; allowed for a file of this size"), std::string::npos) << message;
  }
}

TEST(PngNumbers, SayWhatTheFileSaysAboutColours) {
  PngFile file = even_png(16, PNG_COLOR_TYPE_RGB, {1, 2, 3, 4, 5, 6});
  file.edit = [](png_structp png, png_infop info) {
    png_set_gAMA(png, info, 0.5);
    png_set_cHRM(png, info, 0.3127, 0.329, 0.7, 0.3, 0.2, 0.7, 0.14, 0.05);
  };
  const PngNumbers numbers = parse_png(file.bytes(), "a.png", 0);
  EXPECT_EQ(numbers.channels, 3);
  EXPECT_EQ(numbers.at(4), 0x304);
  EXPECT_EQ(numbers.largest(), 65535);
  EXPECT_NEAR(numbers.gamma.value(), 0.5, 1e-5);
  EXPECT_NEAR(numbers.chromaticities.value().green.y, 0.7, 1e-5);
  EXPECT_FALSE(numbers.is_srgb);
  EXPECT_FALSE(numbers.has_profile);
}

// A field of 0 to 1000 nm over a plane that fills the picture.
double mean_thickness(const PngFile& file) {
  const ScratchFolder folder;
  folder.write("field.png", file.bytes());
  const Scene scene = load_scene(folder.write("scene.toml", R"(
[camera]
position = [0, 0, 100]
look_at = [0, 0, 0]
up = [0, 1, 0]
fov_deg = 0.2
[render]
width = 2
height = 2
spp = 4
[environment]
color = 1
[[material]]
name = "m"
type = "skin"
film_thickness_nm = { from = 0, to = 1000, file = "field.png" }
[[object]]
type = "plane"
half_size = 1
material = "m"
)"));
  const RenderResult result = render_with(scene, Lambert(Rgb(0.5)), {.first_hits = true});
  double sum = 0;
  for (const float value : result.first_hits->film_thickness_nm) sum += value / 4;
  return sum;
}

TEST(PngFields, HaveTheThicknessThatIsStored) {
  for (const Edit& edit : kColorChunks) {
    PngFile wide = even_png(16, PNG_COLOR_TYPE_GRAY, {0x80, 0x00}),
            narrow = even_png(8, PNG_COLOR_TYPE_GRAY, {128});
    wide.edit = narrow.edit = edit;
    EXPECT_NEAR(mean_thickness(wide), 500.0, 0.05);
    EXPECT_NEAR(mean_thickness(narrow), 502.0, 0.05);
  }
}

}  // namespace
}  // namespace sunbeam
