// Charts and pictures of a report hold the values of the material that they show, each at its place.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "bake/report/error_chart.h"
#include "bake/report/polar_chart.h"
#include "bake/report/slice.h"
#include "bake/report/sphere.h"

namespace sunbeam {
namespace {

// A material whose parts are given functions.
class Fake final : public Appearance {
 public:
  using Part = std::function<Rgb(const Vec3& a, const Vec3& b)>;
  Fake(Part first, Part rest) : first_(std::move(first)), rest_(std::move(rest)) { material_.roughness = 0; }

  const Material& material() const override { return material_; }
  Rgb first(const Vec3& a, const Vec3& b) const override { return first_(a, b); }
  Rgb dirac(const Vec3&) const override { return {}; }
  std::vector<Rgb> rest(const Vec3& a, std::span<const Vec3> b) const override {
    std::vector<Rgb> values;
    for (const Vec3& w : b) values.push_back(rest_(a, w));
    return values;
  }

 private:
  Part first_, rest_;
  Material material_;
};

Rgb black(const Vec3&, const Vec3&) { return {}; }

struct Place {
  double x, y;
};

// The points of the paths of that width, a path a list, in the order of the text.
std::vector<std::vector<Place>> curves_of_width(const std::string& svg, const std::string& width) {
  std::vector<std::vector<Place>> curves;
  for (std::size_t at = svg.find("<path d=\""); at != std::string::npos;
       at = svg.find("<path d=\"", at + 1)) {
    const std::string path = svg.substr(at, svg.find("/>", at) - at);
    if (path.find("stroke-width=\"" + width + "\"") == std::string::npos) continue;
    std::string data = path.substr(9, path.find('"', 9) - 9);
    std::replace_if(
        data.begin(), data.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
    std::istringstream in(data);
    curves.emplace_back();
    for (Place place{}; in >> place.x >> place.y;) curves.back().push_back(place);
  }
  return curves;
}

// Light arrives from the left of the chart at 30 degrees. The material sends 1 to the mirror's side, which is
// the right one, and a quarter back; in green a half and in blue a quarter of it. Live it is four times
// darker.
TEST(PolarChart, HoldsBrdfTimesCosineAtEveryAngle) {
  const Vec3 wi = spherical_direction(kPi / 6, 0);
  const auto towards = [](const Vec3& wo) { return (wo.x < 0 ? 1.0 : 0.25) * Rgb(1, 0.5, 0.25); };
  const Fake table([&](const Vec3& wo, const Vec3&) { return towards(wo); }, black);
  const Fake live(black, [&](const Vec3&, const Vec3& wo) { return 0.25 * towards(wo); });
  const std::string svg = polar_chart(table, live, wi);
  for (const auto& [width, strength] : {std::pair("1.3", 1.0), std::pair("5", 0.25)}) {
    const auto curves = curves_of_width(svg, width);
    ASSERT_GE(curves.size(), 3u);
    for (std::size_t c = 0; c < 3; ++c) {
      const double channel = std::array{1.0, 0.5, 0.25}[c];
      ASSERT_EQ(curves[c].size(), 359u);
      for (std::size_t k = 0; k < 359; ++k) {
        const double theta = ((static_cast<double>(k) + 0.5) / 359 - 0.5) * kPi, side = theta > 0 ? 1 : 0.25;
        const double radius = 140 * std::sqrt(strength * channel * side * std::cos(theta));
        if (k == 179) continue;  // straight up belongs to neither side
        EXPECT_NEAR(curves[c][k].x, 170 + radius * std::sin(theta), 0.06) << width << ' ' << c << ' ' << k;
        EXPECT_NEAR(curves[c][k].y, 168 - radius * std::cos(theta), 0.06) << width << ' ' << c << ' ' << k;
      }
    }
  }
  EXPECT_NE(
      svg.find("<path d=\"M170 168L100.0 46.8\" stroke=\"currentColor\" stroke-opacity=\"0.6\" stroke-width"),
      std::string::npos);  // the light itself, 30 degrees to the left
}

// In each of 14 stretches of the axis 45 points of 0.015 %, 10 of 0.15 %, 43 of 0.4 % and 2 of 0.8 %. The
// error's axis is logarithmic from 0.01 to 1 %, at a tolerance of 0.5 %.
TEST(ErrorChart, HoldsMedianAndP99OfEveryStretch) {
  VerifyReport report{};
  ErrorAxis axis{"base_ior", "", 1, 2, {1, 2}, {}};
  for (int k = 0; k < 1400; ++k) {
    VerifyPoint point;
    point.error = k % 100 < 45 ? 0.00015 : k % 100 < 55 ? 0.0015 : k % 100 < 98 ? 0.004 : 0.008;
    report.points.push_back(point);
    axis.values.push_back(1 + (k / 100 + 0.5) / 14);
  }
  const auto lines = curves_of_width(error_chart(axis, report, 0.005), "2.2");
  ASSERT_EQ(lines.size(), 2u);
  for (const auto& [line, percent] : {std::pair(0, 0.15), std::pair(1, 0.8)}) {
    const auto& points = lines[static_cast<std::size_t>(line)];
    ASSERT_EQ(points.size(), 14u);
    for (std::size_t k = 0; k < 14; ++k) {
      EXPECT_NEAR(points[k].x, 60 + 430 * (static_cast<double>(k) + 0.5) / 14, 0.06);
      EXPECT_NEAR(points[k].y, 26 + 196 * (1 - std::log10(percent / 0.01) / 2), 0.06);
    }
  }
}

// Columns are theta_o, from -90 degrees on the light's side to 90 on the mirror's; rows are theta_i, 0 at the
// bottom.
TEST(SliceImage, HoldsPiTimesTheRestOfEveryPair) {
  const Fake skin(black, [](const Vec3& wi, const Vec3& wo) { return kInvPi * Rgb(wi.x, wo.x, wo.z); });
  const Image image = slice_image(skin, 4, 1);
  ASSERT_EQ(image.width, 8);
  ASSERT_EQ(image.height, 4);
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 4; ++y) {
      const double theta_o = (x - 3.5) * kPi / 8, theta_i = (3.5 - y) * kPi / 8;
      const Rgb found = image.get(x, y);
      EXPECT_NEAR(found.r, std::sin(theta_i), 1e-6) << x << ' ' << y;
      EXPECT_NEAR(found.g, -std::sin(theta_o), 1e-6) << x << ' ' << y;
      EXPECT_NEAR(found.b, std::cos(theta_o), 1e-6) << x << ' ' << y;
    }
}

// The sky is the same on the left and on the right, so that two mirrored pixels of a white diffuser differ by
// the light alone: 1.5 / pi times the difference of its cosines. It stands at the upper left.
TEST(SphereImage, IsLitFromTheUpperLeft) {
  const Fake skin(black, [](const Vec3&, const Vec3&) { return Rgb(kInvPi); });
  constexpr int kPixels = 64;
  const Image image = sphere_image(skin, kPixels, 1);
  const Vec3 light = normalize({-0.55, 0.65, 0.6});
  for (const auto& [column, row] : {std::pair(20, 20), std::pair(24, 40), std::pair(14, 30)}) {
    const double x = ((column + 0.5) * 2 / kPixels - 1) / 0.96, y = (1 - (row + 0.5) * 2 / kPixels) / 0.96;
    const double z = std::sqrt(1 - x * x - y * y);
    const double left = std::max(0.0, dot(light, {x, y, z})), right = std::max(0.0, dot(light, {-x, y, z}));
    EXPECT_NEAR(image.get(column, row).g - image.get(kPixels - 1 - column, row).g,
                1.5 * kInvPi * (left - right), 0.01)
        << column << ' ' << row;
  }
}

}  // namespace
}  // namespace sunbeam
