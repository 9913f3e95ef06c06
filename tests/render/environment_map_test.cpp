// What environments are read from: EXR and Radiance files, and what is refused.
#include "runtime/tracer/environment_map.h"

#include <ImfEnvmap.h>

#include <limits>

#include "tests/render/exr_files.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

EnvironmentMap read(const std::string& bytes) { return parse_environment_map(bytes, "sky"); }

std::string refusal(const std::string& bytes) {
  const std::string message = error_of([&] { read(bytes); });
  EXPECT_TRUE(message.starts_with("sky: ")) << message;
  return message;
}

// Pixel (x, y) of the data window is 1 + x + 10 y.
ExrPart window_part(const Imath::Box2i& display, const Imath::V2i& corner, int width, int height) {
  const ChannelValue value = [](int x, int y) { return static_cast<float>(1 + x + 10 * y); };
  ExrPart part = rgb_part(width, height, value, value, value);
  part.display = display;
  part.corner = corner;
  return part;
}

TEST(EnvironmentMap, PixelsOutsideOfTheDataWindowAreBlack) {
  const EnvironmentMap sky = read(exr_file({window_part({{-2, 5}, {5, 8}}, {1, 6}, 3, 2)}));
  ASSERT_EQ(sky.map.width, 8);
  ASSERT_EQ(sky.map.height, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      const bool is_inside = x >= 3 && x < 6 && y >= 1 && y < 3;
      EXPECT_EQ(sky.map.get(x, y), Rgb(is_inside ? 1 + (x - 3) + 10 * (y - 1) : 0)) << x << " " << y;
    }
  ASSERT_EQ(sky.warnings.size(), 1u);
  EXPECT_NE(sky.warnings[0].find("display window of 8 x 4"), std::string::npos) << sky.warnings[0];
}

TEST(EnvironmentMap, PixelsBeyondTheDisplayWindowAreCutOff) {
  const EnvironmentMap sky = read(exr_file({window_part({{0, 0}, {1, 1}}, {-1, -1}, 5, 4)}));
  ASSERT_EQ(sky.map.width, 2);
  EXPECT_EQ(sky.map.get(0, 0), Rgb(12));
  EXPECT_EQ(sky.map.get(1, 1), Rgb(23));
  const EnvironmentMap apart = read(exr_file({window_part({{0, 0}, {1, 1}}, {7, 7}, 2, 2)}));
  EXPECT_EQ(apart.map.rgb, std::vector<float>(12, 0.0f));
}

TEST(EnvironmentMap, NegativeComponentsCountAsZeroAndAreCounted) {
  const EnvironmentMap sky = read(exr_file({rgb_part(
      4, 3, constant(1), [](int x, int y) { return x == 2 ? -0.25f * static_cast<float>(1 + y) : 2.0f; },
      constant(3))}));
  EXPECT_EQ(sky.map.get(2, 1), Rgb(1, 0, 3));
  EXPECT_EQ(sky.map.get(1, 1), Rgb(1, 2, 3));
  ASSERT_EQ(sky.warnings.size(), 1u);
  EXPECT_EQ(sky.warnings[0], "sky: 3 of 12 pixels have negative components, which count as 0 (lowest -0.75)");
  EXPECT_TRUE(read(exr_file({grey_part(4, 2, 1)})).warnings.empty());
}

TEST(EnvironmentMap, CubeMapsAreRefusedByName) {
  ExrPart part = grey_part(2, 12, 1);
  part.edit = [](Imf::Header& header) { Imf::addEnvmap(header, Imf::ENVMAP_CUBE); };
  EXPECT_NE(refusal(exr_file({part})).find("cube map; allowed: latlong"), std::string::npos);
  part.edit = [](Imf::Header& header) { Imf::addEnvmap(header, Imf::ENVMAP_LATLONG); };
  EXPECT_EQ(read(exr_file({part})).map.get(0, 0), Rgb(1));
}

TEST(EnvironmentMap, RadiancePicturesAreRead) {
  const std::string pixels = "\x80\x40\x20\x81\x80\x40\x20\x82";
  const EnvironmentMap sky = read("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + pixels);
  EXPECT_EQ(sky.map.get(0, 0), Rgb(1, 0.5, 0.25));
  EXPECT_EQ(sky.map.get(1, 0), Rgb(2, 1, 0.5));
}

TEST(EnvironmentMap, OtherFilesAndHeadersThatClaimTooMuchAreRefused) {
  EXPECT_NE(refusal("\x89PNG\r\n\x1a\n").find("neither EXR nor Radiance"), std::string::npos);
  EXPECT_NE(refusal("").find("neither EXR nor Radiance"), std::string::npos);
  const std::string small = exr_file({grey_part(4, 3, 1)});
  EXPECT_NE(refusal(with_most_rows(small, "dataWindow")).find("data windows ask for"), std::string::npos);
  EXPECT_NE(refusal(with_most_rows(small, "displayWindow")).find("of memory; allowed"), std::string::npos);
}

// Skies of the scenes under test: a plane of albedo 0.5 that sees nothing but the map.
RenderResult plane_under(const std::string& bytes) {
  const ScratchFolder folder;
  folder.write("sky.exr", bytes);
  const Scene scene = load_scene(folder.write("scene.toml", R"(
[camera]
position = [0, 0, 100]
look_at = [0, 0, 0]
up = [0, 1, 0]
fov_deg = 0.2
[render]
width = 16
height = 16
spp = 64
max_bounces = 1
[environment]
file = "sky.exr"
[[material]]
name = "m"
type = "diffuse"
[[object]]
type = "plane"
half_size = 10
material = "m"
)"));
  return render_with(scene, Lambert(Rgb(0.5)), {});
}

TEST(EnvironmentMap, HalfASkyInItsDataWindowGivesHalfTheLight) {
  ExrPart part = grey_part(8, 8, 1);
  part.corner = {8, 0};
  part.display = {{0, 0}, {15, 7}};
  const Estimate found = grey_estimate(plane_under(exr_file({part})));
  // 5 standard errors: false alarm 6e-7.
  EXPECT_NEAR(found.mean, 0.25, 5 * found.standard_error);
  EXPECT_LT(found.standard_error, 0.01);
}

TEST(EnvironmentMap, ASkyInAp1GivesItsRec709) {
  ExrPart part = rgb_part(16, 8, constant(0.5f), constant(0.2f), constant(0.05f));
  part.edit = [](Imf::Header& header) {
    Imf::addChromaticities(header,
                           {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}});
  };
  const RenderResult result = plane_under(exr_file({part}));
  const double expected[3] = {0.362, 0.081, 0.010};
  for (int channel = 0; channel < 3; ++channel) {
    double sum = 0, variance = 0;
    for (int k = 0; k < 256; ++k) {
      sum += result.mean.at(static_cast<std::size_t>(k))[channel];
      variance += result.variance.at(static_cast<std::size_t>(k))[channel];
    }
    // 5 standard errors and the digits of what is expected.
    EXPECT_NEAR(sum / 256, expected[channel], 5e-4 + 5 * std::sqrt(variance) / 256);
  }
}

}  // namespace
}  // namespace sunbeam
