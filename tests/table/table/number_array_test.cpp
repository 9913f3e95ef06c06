// Arrays of single numbers: one channel that looks the same in every channel of a colour.
#include <gtest/gtest.h>

#include "sunbeam/detail/nd_array.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

Axis cubic(const std::string& name, std::vector<double> nodes) {
  Axis axis = test::axis(name, std::move(nodes));
  axis.is_cubic = true;
  return axis;
}

// (1 + x)^3 y at the nodes of a cubic and a linear axis.
NdArray product() {
  NdArray array("thing", {cubic("x", {0, 1, 2, 3, 4}), test::axis("y", {1, 2})}, Precision::single_float, 1);
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      array.set(2 * i + j, Rgb(std::pow(1 + static_cast<double>(i), 3) * (1 + static_cast<double>(j))));
  return array;
}

TEST(NumberArray, HoldsOneValueACell) {
  const NdArray array = product();
  EXPECT_EQ(array.channels(), 1u);
  EXPECT_EQ(array.cells(), 10u);
  EXPECT_EQ(array.values().size(), 10u);
  EXPECT_EQ(array.values()[3], 16.0f);
  EXPECT_EQ(array.get(3), Rgb(16));
  EXPECT_EQ(NdArray("thing", array.axes(), Precision::single_float).values().size(), 30u);
}

TEST(NumberArray, TakesTheFirstChannel) {
  NdArray array = product();
  array.set(4, {0.5, 7, 9});
  EXPECT_EQ(array.get(4), Rgb(0.5));
  EXPECT_EQ(array.get(5), Rgb(54));  // its neighbour is untouched
}

// Halves have 11 bits; -0 becomes 0 so that every file form keeps it.
TEST(NumberArray, RoundsToItsPrecision) {
  NdArray array("thing", {test::axis("x", {0, 1})}, Precision::half_float, 1);
  array.set(0, Rgb(1 + 0x1p-12));
  array.set(1, Rgb(-1e-9));
  EXPECT_EQ(array.values()[0], 1.0f);
  EXPECT_FALSE(std::signbit(array.values()[1]));
}

// Small integers are exact in floats, and a cubic along a cubic axis is exact: rounding alone, 1e-13 of 250.
TEST(NumberArray, InterpolatesAlongEachAxis) {
  const NdArray array = product();
  for (const double x : {0.0, 0.3, 1.5, 2.25, 3.9, 4.0})
    for (const double y : {1.0, 1.25, 2.0})
      EXPECT_NEAR(array.interpolate(std::array{x, y}).g, std::pow(1 + x, 3) * y, 1e-11) << x << ' ' << y;
}

// A slice is rounded to a float: 2^-24 of values up to 250.
TEST(NumberArray, SlicesAlongTheLeadingAxes) {
  const NdArray array = product();
  const NdArray slice = array.slice(std::array{1.5});
  ASSERT_EQ(slice.axes().size(), 1u);
  EXPECT_EQ(slice.axes()[0].name, "y");
  EXPECT_EQ(slice.channels(), 1u);
  for (const double y : {1.0, 1.3, 2.0})
    EXPECT_NEAR(slice.interpolate(std::array{y}).r, array.interpolate(std::array{1.5, y}).r, 250 * 0x1p-24);
}

TEST(NumberArray, IsNotAnArrayOfColours) {
  const NdArray numbers("thing", {test::axis("x", {0})}, Precision::single_float, 1);
  EXPECT_FALSE(numbers == NdArray("thing", {test::axis("x", {0})}, Precision::single_float));
}

}  // namespace
}  // namespace sunbeam
