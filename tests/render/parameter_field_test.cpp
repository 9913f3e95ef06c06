// Parameter fields by value.
#include "runtime/tracer/parameter_field.h"

#include <gtest/gtest.h>

namespace sunbeam {
namespace {

// 4 x 8 pixels without any symmetry.
std::shared_ptr<HeightMap> uneven_map() {
  auto map = std::make_shared<HeightMap>(HeightMap{4, 8, {}});
  for (int k = 0; k < 32; ++k) map->values.push_back(static_cast<float>((k * 7 + k * k) % 32) / 31);
  return map;
}

ParameterField field_of(ParameterField::Kind kind, const Point2& along) {
  return {kind, 200, 600, along, kind == ParameterField::Kind::map ? uneven_map() : nullptr};
}

TEST(ParameterField, MapIsRepeatedTwiceAlongUAndThriceAlongV) {
  const auto map = uneven_map();
  const ParameterField field = field_of(ParameterField::Kind::map, {2, 3});
  double low = 600, high = 200;
  for (const Point2& uv : {Point2{0.1, 0.2}, Point2{0.3, 0.45}, Point2{0.8, 0.15}, Point2{0.55, 0.9}}) {
    const double value = field.at(uv);
    EXPECT_NEAR(value, 200 + 400 * map->sample({2 * uv.x, 3 * uv.y}).height, 1e-9) << uv.x;
    EXPECT_NEAR(value, field.at({uv.x + 0.5, uv.y}), 1e-9) << uv.x;
    EXPECT_NEAR(value, field.at({uv.x, uv.y + 1.0 / 3}), 1e-9) << uv.x;
    EXPECT_GT(std::abs(value - field.at({uv.x + 1.0 / 3, uv.y})), 1) << uv.x;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  EXPECT_GT(high - low, 50);
}

TEST(ParameterField, RampsAndBandsRunAlongBothCoordinates) {
  const ParameterField ramp = field_of(ParameterField::Kind::ramp, {0.25, 0.5});
  EXPECT_NEAR(ramp.at({1, 0.5}), 400, 1e-9);  // s = 0.25 + 0.25
  EXPECT_NEAR(ramp.at({0.4, 0.2}), 280, 1e-9);
  EXPECT_NEAR(ramp.at({-1, 0}), 200, 1e-9);
  EXPECT_NEAR(ramp.at({2, 2}), 600, 1e-9);
  const ParameterField bands = field_of(ParameterField::Kind::bands, {1, 2});
  EXPECT_NEAR(bands.at({0.25, 0.25}), 200 + 400 * 0.5, 1e-9);  // x = 3/4
  EXPECT_NEAR(bands.at({0, 0.25}), 600, 1e-9);                 // x = 1/2
  EXPECT_NEAR(bands.at({1.0 / 6, 0}), 300, 1e-9);              // (1 - cos 60) / 2 = 1/4
}

}  // namespace
}  // namespace sunbeam
