#include "sunbeam/detail/nd_array.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sunbeam/core/error.h"
#include "sunbeam/core/rng.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

using test::axis;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(NdArray, RowMajorStrides) {
  const NdArray array("a", {axis("x", {0, 1}), axis("y", {0, 1, 2}), axis("z", {0, 1, 2, 3})},
                      Precision::single_float);
  EXPECT_EQ(array.cells(), 24u);
  EXPECT_EQ(array.values().size(), 72u);
  EXPECT_EQ(array.stride(0), 12u);
  EXPECT_EQ(array.stride(1), 4u);
  EXPECT_EQ(array.stride(2), 1u);
  for (const float value : array.values()) EXPECT_EQ(value, 0);
  EXPECT_TRUE(NdArray().empty());
  EXPECT_FALSE(array.empty());
}

// Half: 11 bits of significand, so 0.1 = 1.6 / 16 becomes 1638 / 16384, and 2049 ties to the even 2048.
// Single: 24 bits.
TEST(NdArray, SetRoundsToThePrecision) {
  NdArray half("a", {axis("x", {0})}, Precision::half_float);
  half.set(0, {0.1, 2049, 65504});
  EXPECT_EQ(half.get(0), Rgb(1638.0 / 16384, 2048, 65504));
  NdArray single("a", {axis("x", {0})}, Precision::single_float);
  single.set(0, {0.1, 2049, 16777217});
  EXPECT_EQ(single.get(0), Rgb(double{0.1f}, 2049, 16777216));
}

// Every file form keeps +0 alone, and a table's hash sees the bits: neither -0 nor what rounds to it stays.
TEST(NdArray, NegativeZeroBecomesZero) {
  for (const Precision precision : {Precision::half_float, Precision::single_float}) {
    NdArray array("a", {axis("x", {0})}, precision);
    array.set(0, {-0.0, -1e-9, -1e-60});  // the smallest half is 6e-8, the smallest float 1e-45
    for (const float value : array.values())
      EXPECT_FALSE(std::signbit(value) && value == 0)
          << value << (precision == Precision::half_float ? " half" : " float");
  }
}

// prod_k (a_k + b_k u_k) with u_k the warped coordinate is what multilinear interpolation reproduces; floats
// round it by 6e-8 of values below 30.
TEST(NdArray, InterpolationIsExactForMultilinearFunctions) {
  std::vector<Axis> axes;
  for (std::size_t k = 0; k < NdArray::kMaxRank; ++k)
    axes.push_back({"x" + std::to_string(k),
                    "1",
                    {0.5, 1.5 + 0.25 * static_cast<double>(k), 4},
                    1 + static_cast<double>(k % 3),
                    0,
                    0.1 * static_cast<double>(k % 2)});
  NdArray array("a", axes, Precision::single_float);
  const auto f = [&](const std::vector<double>& x) {
    Rgb value(1);
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const double u = std::pow(x[k] - axes[k].origin, 1 / axes[k].power);
      value *= Rgb(1 + 0.2 * u, 1.5 - 0.3 * u, 0.5 + 0.1 * static_cast<double>(k) * u);
    }
    return value;
  };
  for (std::size_t cell = 0; cell < array.cells(); ++cell) {
    std::vector<double> x;
    for (std::size_t k = 0; k < axes.size(); ++k) x.push_back(axes[k].nodes[cell / array.stride(k) % 3]);
    array.set(cell, f(x));
  }
  Rng rng(1, 0);
  for (int n = 0; n < 2000; ++n) {
    std::vector<double> x;
    for (std::size_t k = 0; k < axes.size(); ++k) x.push_back(lerp(rng.uniform(), 0.5, 4));
    const Rgb expected = f(x), found = array.interpolate(x);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 30 * 1e-7) << c;
  }
}

TEST(NdArray, OutsideIsClamped) {
  NdArray array("a", {axis("x", {1, 2}), axis("y", {0, 1})}, Precision::single_float);
  for (std::size_t cell = 0; cell < 4; ++cell) array.set(cell, Rgb(static_cast<double>(cell)));
  EXPECT_EQ(array.interpolate(std::array{-9.0, 7.0}), Rgb(1));  // x at its first, y at its last node
  EXPECT_EQ(array.interpolate(std::array{9.0, -7.0}), Rgb(2));
}

// Slicing and then interpolating is one interpolation; a slice is rounded to floats on the way.
TEST(NdArray, SliceThenInterpolateIsInterpolate) {
  const std::vector<Axis> axes = {axis("a", {0, 1, 3}, 2), axis("b", {1, 2}), axis("c", {0, 2, 5}, 3),
                                  test::full_circle("d", 5)};
  NdArray array("v", axes, Precision::half_float);
  test::fill_randomly(array, -1, 1, 0);
  Rng rng(2, 0);
  for (int n = 0; n < 500; ++n) {
    const std::array x{3.5 * rng.uniform(), 0.5 + 2 * rng.uniform(), 6 * rng.uniform(), 9 * rng.uniform()};
    const Rgb expected = array.interpolate(x);
    for (const std::size_t leading : {1u, 2u, 3u}) {
      const NdArray slice = array.slice(std::span(x).first(leading));
      ASSERT_EQ(slice.axes(), std::vector<Axis>(axes.begin() + leading, axes.end()));
      const Rgb found = slice.interpolate(std::span(x).subspan(leading));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1.2e-7);  // floats of size up to 1
    }
  }
}

std::string refusal(std::vector<Axis> axes) {
  try {
    const NdArray array("thing", std::move(axes), Precision::single_float);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(NdArray, RefusesBadShapes) {
  EXPECT_THAT(refusal({}), AllOf(HasSubstr("'thing'"), HasSubstr("0 axes"), HasSubstr("1 to 9")));
  EXPECT_EQ(refusal(std::vector<Axis>(8, axis("x", {0}))), "accepted");
  EXPECT_THAT(refusal(std::vector<Axis>(10, axis("x", {0}))), HasSubstr("10 axes"));
  EXPECT_THAT(refusal({axis("fine", {0}), axis("poor", {1, 0})}),
              AllOf(HasSubstr("'thing'"), HasSubstr("'poor'"), HasSubstr("do not increase")));
  // 1024^4 = 2^40 cells; refused before a byte is allocated.
  EXPECT_THAT(refusal(std::vector<Axis>(4, axis("x", spaced_nodes(0, 1, 1024)))), HasSubstr("2^32 cells"));
}

}  // namespace
}  // namespace sunbeam
