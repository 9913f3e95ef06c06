#include "sunbeam/detail/text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

void expect_round_trip(double value) {
  double back = 0;
  ASSERT_TRUE(parse_number(to_text(value), back)) << to_text(value);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value)) << to_text(value);
}

TEST(Text, RoundTripKeepsEveryBit) {
  for (const double value : {0.0, -0.0, 0.1, 1.0 / 3, 1e-310, 5e-324, 1.7976931348623157e308, 123456789.0})
    expect_round_trip(value);
  Rng rng(1, 0);
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t high = rng.next();
    const double value = std::bit_cast<double>(high << 32 | rng.next());
    if (std::isfinite(value)) expect_round_trip(value);
  }
}

TEST(Text, ShortestForm) {
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(300.0), "300");
  EXPECT_EQ(to_text(std::vector<double>{1, 0.5, -2}), "1 0.5 -2");
  EXPECT_EQ(to_text(std::vector<double>{}), "");
}

TEST(Text, ParseTakesTheWholeTextOrNothing) {
  double value = 0;
  EXPECT_TRUE(parse_number(" 1.5 ", value));
  EXPECT_EQ(value, 1.5);
  EXPECT_TRUE(parse_number("+2e3\r", value));
  EXPECT_EQ(value, 2000);
  EXPECT_TRUE(parse_number("inf", value));
  EXPECT_EQ(value, std::numeric_limits<double>::infinity());
  for (const char* bad : {"", " ", "1.5x", "x", "1 2", "1,5", "--1", "0x10", "1e", "+"})
    EXPECT_FALSE(parse_number(bad, value)) << bad;
}

TEST(Text, ANumberTooSmallForADoubleIsZero) {
  for (const char* tiny : {"1e-400", "-2.5E-9999", "0.1e-400", "+1e-400"}) {
    double value = 1;
    EXPECT_TRUE(parse_number(tiny, value)) << tiny;
    EXPECT_EQ(value, 0) << tiny;
  }
  double value = 1;
  EXPECT_TRUE(parse_number("0." + std::string(400, '0') + "1", value));
  EXPECT_EQ(value, 0);
  EXPECT_TRUE(parse_number("1e-310", value));
  EXPECT_EQ(value, 1e-310);
  for (const std::string& large : {std::string("1e400"), std::string("-1e+400"), "1" + std::string(400, '0')})
    EXPECT_FALSE(parse_number(large, value)) << large;
}

// "+-1" is no number in any notation.
TEST(Text, ParseRefusesTwoSigns) {
  double value = 0;
  EXPECT_FALSE(parse_number("+-1", value));
}

TEST(Text, SplitKeepsEmptyParts) {
  EXPECT_EQ(split("a;b;c", ';'), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(split(";a;", ';'), (std::vector<std::string>{"", "a", ""}));
  EXPECT_EQ(split("", ';'), (std::vector<std::string>{""}));
}

TEST(Text, ByteOrderMarkGoes) {
  EXPECT_EQ(without_byte_order_mark("\xef\xbb\xbf[scene]"), "[scene]");
  EXPECT_EQ(without_byte_order_mark("[scene]\xef\xbb\xbf"), "[scene]\xef\xbb\xbf");
  EXPECT_EQ(without_byte_order_mark("\xef\xbb"), "\xef\xbb");
}

TEST(Text, PrintableShowsControlCharacters) {
  EXPECT_EQ(printable("a\nb\tc\r\x1b[31m\x7f"), "a\\nb\\tc\\x0d\\x1b[31m\\x7f");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\xc2\\x9b31m");
  EXPECT_EQ(printable("Zürich, 45°, \xc2\xa0"), "Zürich, 45°, \xc2\xa0");
}

TEST(Text, WholeNumbersAreDigitsAlone) {
  std::uint64_t value = 0;
  EXPECT_TRUE(parse_whole_number("18446744073709551615", value));
  EXPECT_EQ(value, 18446744073709551615u);
  EXPECT_TRUE(parse_whole_number("007", value));
  EXPECT_EQ(value, 7u);
  for (const char* text : {"", "18446744073709551616", "-1", "+1", " 1", "1 ", "1.0", "1e3", "0x1", "x"})
    EXPECT_FALSE(parse_whole_number(text, value)) << text;
}

TEST(Text, ShortenedIsTheBeginning) {
  EXPECT_EQ(shortened(std::string(100, 'a')), std::string(100, 'a'));
  EXPECT_EQ(shortened(std::string(101, 'a')), std::string(100, 'a') + "...");
}

TEST(Text, PlainTextIsUtf8WithoutControlCharacters) {
  for (const char* text : {"", "a b\tc\n", "\u00e4\u20ac\U0001f40d\u00a0", "\uffff"})
    EXPECT_TRUE(is_plain_text(text)) << text;
  for (const std::string& text :
       {std::string("\0", 1), std::string("\x1b[31m"), std::string("\r"), std::string("\x7f"),
        std::string("\xc2\x85"),                                                                 // U+0085
        std::string("\xff"), std::string("\xc3"), std::string("\x80"), std::string("\xe2\x82"),  // cut short
        std::string("\xc0\xaf"), std::string("\xe0\x80\xaf"), std::string("\xf0\x80\x80\xaf"),   // overlong
        std::string("\xed\xa0\x80"), std::string("\xf4\x90\x80\x80"), std::string("\xf5\x80\x80\x80")})
    EXPECT_FALSE(is_plain_text(text)) << printable(text);
}

TEST(Text, AnExcerptIsShortAndPrintable) {
  EXPECT_EQ(excerpt("a\nb"), "a\\nb");
  EXPECT_EQ(excerpt(std::string(60, 'x')), std::string(60, 'x'));
  EXPECT_EQ(excerpt(std::string(61, 'x')), std::string(60, 'x') + "...");
}

}  // namespace
}  // namespace sunbeam
