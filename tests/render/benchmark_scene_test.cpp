// The scenes that speed is measured in show what they should. The references are those of three independent
// renderers. Seeds are fixed; four standard errors beyond the bounds would be exceeded by chance in 6 of
// 100,000 seeds.
#include <gtest/gtest.h>

#include "tests/render/support.h"

namespace sunbeam {
namespace {

Scene bench_scene(const std::string& name) {
  return load_scene(std::string(SUNBEAM_SCENES_DIR) + "/bench_" + name + ".toml");
}

Estimate estimate(const Scene& scene, const PixelWindow& window, int spp) {
  const Lambert grey(scene.diffuse_albedo);
  return grey_estimate(
      render_with(scene, grey, {.width = window.width, .height = window.height, .spp = spp, .crop = window}));
}

void expect_mean(const Estimate& found, double expected, double tolerance) {
  EXPECT_NEAR(found.mean, expected, tolerance * expected + 4 * found.standard_error);
  EXPECT_LT(found.standard_error, 0.5 * tolerance * expected);  // else the test could hardly fail
}

std::size_t triangles_of_first_object(const Scene& scene) {
  return std::get<Mesh>(scene.objects[0].shape).triangles.size();
}

TEST(BenchmarkScene, HasItsTriangles) {
  EXPECT_EQ(triangles_of_first_object(bench_scene("sphere")), 65024u);
  EXPECT_EQ(triangles_of_first_object(bench_scene("torus")), 1000000u);
}

// Albedo 0.5; the references agree within 0.04 %.
TEST(BenchmarkScene, SphereHasTheKnownMeanRadiance) {
  expect_mean(estimate(bench_scene("sphere"), PixelWindow::whole(320, 180), 64), 0.3883, 0.001);
}

TEST(BenchmarkScene, SphereHasTheKnownRadianceAtTheBottomAndInTheCentre) {
  const Scene scene = bench_scene("sphere");
  expect_mean(estimate(scene, {320, 180, 0, 162, 320, 180}, 64), 0.4385, 0.005);
  expect_mean(estimate(scene, {320, 180, 144, 72, 176, 108}, 512), 0.347, 0.005);
}

}  // namespace
}  // namespace sunbeam
