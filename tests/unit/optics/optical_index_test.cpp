// Refractive indices over wavelength: their values, and what is refused.
#include "bake/optics/dispersion/optical_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Complex = std::complex<double>;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string cauchy_error(const std::array<double, 3>& coefficients, double k = 0) {
  return error_of([&] { OpticalIndex::cauchy(coefficients, k); });
}
std::string measured_error(const std::vector<OpticalConstants>& lines) {
  return error_of([&] { OpticalIndex::measured(lines); });
}

TEST(OpticalIndex, ANumberIsItselfAtEveryWavelength) {
  const auto index = OpticalIndex::constant(1.56, 0.3);
  for (const double nm : {100.0, 380.0, 555.5, 10000.0}) EXPECT_EQ(index.at(nm), Complex(1.56, 0.3));
}

TEST(OpticalIndex, CauchysFormulaAtExactWavelengths) {
  const auto index = OpticalIndex::cauchy({1.5, 10000, 2e8}, 0.25);
  EXPECT_DOUBLE_EQ(index.at(500).real(), 1.5 + 0.04 + 0.0032);
  EXPECT_DOUBLE_EQ(index.at(1000).real(), 1.5 + 0.01 + 0.0002);
  EXPECT_EQ(index.at(1000).imag(), 0.25);
}

TEST(OpticalIndex, MeasuredValuesAreJoinedByStraightLines) {
  const auto index = OpticalIndex::measured({{380, 2, 0}, {500, 1.5, 0.25}, {800, 3, 1}});
  EXPECT_EQ(index.at(380), Complex(2, 0));
  EXPECT_EQ(index.at(500), Complex(1.5, 0.25));
  EXPECT_EQ(index.at(800), Complex(3, 1));
  EXPECT_EQ(index.at(440), Complex(1.75, 0.125));
  EXPECT_EQ(index.at(600), Complex(2, 0.5));
}

TEST(OpticalIndex, TheEndsOfAListHoldAtVisibleWavelengthsOnly) {
  const auto index = OpticalIndex::measured({{400, 1.6, 0}, {700, 1.5, 0.01}});
  EXPECT_EQ(index.at(380), Complex(1.6, 0));
  EXPECT_EQ(index.at(780), Complex(1.5, 0.01));
  for (const double nm : {379.0, 781.0, 0.0, -1.0, kNaN, kInfinity})
    EXPECT_THAT(error_of([&] { index.at(nm); }), HasSubstr("allow 380 to 780 nm")) << nm;
  const auto wide = OpticalIndex::measured({{300, 1.6, 0}, {1000, 1.5, 0}});
  EXPECT_EQ(wide.at(300), Complex(1.6, 0));
  EXPECT_EQ(wide.at(1000), Complex(1.5, 0));
  EXPECT_THAT(error_of([&] { wide.at(299); }), AllOf(HasSubstr("299 nm"), HasSubstr("300 to 1000 nm")));
}

TEST(OpticalIndex, RangesIncludeTheirEnds) {
  EXPECT_EQ(OpticalIndex::constant(0.05, 100).at(550), Complex(0.05, 100));
  EXPECT_EQ(OpticalIndex::constant(10, 0).at(550), Complex(10, 0));
  EXPECT_EQ(measured_error({{400, 0.05, 100}, {700, 10, 0}}), "");
}

TEST(OpticalIndex, RefusesNumbersOutOfRange) {
  for (const double n : {0.049, 0.0, -1.5, 10.1, kNaN, kInfinity})
    EXPECT_THAT(error_of([&] { OpticalIndex::constant(n); }),
                AllOf(HasSubstr("n = "), HasSubstr("0.05 to 10")))
        << n;
  for (const double k : {-1e-9, 100.1, kNaN, kInfinity})
    EXPECT_THAT(error_of([&] { OpticalIndex::constant(1.5, k); }),
                AllOf(HasSubstr("k = "), HasSubstr("0 to 100")))
        << k;
}

TEST(OpticalIndex, RefusesCauchysFormulaWhereItLeavesTheRangeOfN) {
  EXPECT_THAT(cauchy_error({9.9, 30000, 0}), AllOf(HasSubstr("at 380 nm"), HasSubstr("0.05 to 10")));
  EXPECT_THAT(cauchy_error({0.1, -20000, 0}), HasSubstr("at 380 nm"));
  EXPECT_THAT(cauchy_error({0.04, 3000, 0}), HasSubstr("at 780 nm"));
  // n = 1 - 1.2 (2 u - u^2) with u = (500 / wavelength)^2 is in range at 380 and 780 nm, and -0.2 at 500 nm.
  EXPECT_THAT(cauchy_error({1, -600000, 1.2 * 6.25e10}), HasSubstr("at 500 nm"));
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e308}) {
    EXPECT_NE(cauchy_error({bad, 0, 0}), "") << bad;
    EXPECT_NE(cauchy_error({1.5, bad, 0}), "") << bad;
    EXPECT_NE(cauchy_error({1.5, 0, bad}), "") << bad;
  }
}

TEST(OpticalIndex, CauchysFormulaIsRefusedWhereItIsAskedBeyondItsRange) {
  const auto index = OpticalIndex::cauchy({1.5, 1e6, 0});
  EXPECT_THAT(error_of([&] { index.at(100); }),
              AllOf(HasSubstr("found n = 101.5 at 100 nm"), HasSubstr("0.05 to 10")));
  EXPECT_NE(error_of([&] { index.at(0); }), "");
}

TEST(OpticalIndex, RefusesListsThatAreNotMeasurements) {
  EXPECT_THAT(measured_error({}), HasSubstr("the list is empty"));
  EXPECT_THAT(measured_error({{401, 1.5, 0}, {700, 1.5, 0}}),
              AllOf(HasSubstr("401 to 700"), HasSubstr("400 nm or less")));
  EXPECT_THAT(measured_error({{400, 1.5, 0}, {699, 1.5, 0}}), HasSubstr("700 nm or more"));
  EXPECT_THAT(measured_error({{550, 1.5, 0}}), HasSubstr("550 to 550"));
  EXPECT_THAT(measured_error({{400, 1.5, 0}, {500, 1.5, 0}, {500, 1.6, 0}, {700, 1.5, 0}}),
              HasSubstr("500 nm after 500 nm"));
  EXPECT_THAT(measured_error({{700, 1.5, 0}, {400, 1.5, 0}}), HasSubstr("400 nm after 700 nm"));
  for (const double nm : {0.0, -5.0, kNaN})
    EXPECT_THAT(measured_error({{nm, 1.5, 0}, {700, 1.5, 0}}), HasSubstr("ascend")) << nm;
  EXPECT_THAT(measured_error({{400, 1.5, 0}, {kInfinity, 1.5, 0}}), HasSubstr("ascend"));
  EXPECT_THAT(measured_error({{400, 1.5, 0}, {500, 11, 0}, {700, 1.5, 0}}),
              AllOf(HasSubstr("n = 11"), HasSubstr("500 nm")));
  EXPECT_THAT(measured_error({{400, 1.5, 0}, {500, 1.5, -1}, {700, 1.5, 0}}),
              AllOf(HasSubstr("k = -1"), HasSubstr("500 nm")));
  EXPECT_NE(measured_error({{400, kNaN, 0}, {700, 1.5, 0}}), "");
  EXPECT_NE(measured_error({{400, 1.5, kNaN}, {700, 1.5, 0}}), "");
}

TEST(OpticalIndex, NamesAreThoseOfTheTables) {
  const auto chitin = OpticalIndex::named("chitin");
  EXPECT_NEAR(chitin.at(500).real(), 1.517 + 8800.0 / 250000, 1e-5);
  EXPECT_EQ(chitin, OpticalIndex::named("chitin"));
  for (const auto& name : optical_table_names()) EXPECT_NO_THROW(OpticalIndex::named(name)) << name;
  for (const char* name : {"", "Chitin", "chitin.csv", "chit", "../chitin"})
    EXPECT_THAT(error_of([&] { OpticalIndex::named(name); }), HasSubstr("such as \"")) << name;
  EXPECT_THAT(error_of([] { OpticalIndex::named("a\nb"); }), HasSubstr("found \"a\\nb\""));
}

}  // namespace
}  // namespace sunbeam
