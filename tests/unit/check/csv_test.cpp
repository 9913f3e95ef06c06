#include "bake/check/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using ::testing::ElementsAre;

std::vector<std::vector<std::string>> cells_of(const Csv& csv) {
  std::vector<std::vector<std::string>> cells;
  for (const CsvRow& row : csv.rows) cells.push_back(row.cells);
  return cells;
}

TEST(Csv, LinesOfARowWithLineEndsInQuotesAreCounted) {
  const Csv csv = parse_csv("a,b\r\n\"1\r\n2\r3\n4\",5\r\n6,7\r\n", "c");
  EXPECT_THAT(cells_of(csv), ElementsAre(ElementsAre("1\r\n2\r3\n4", "5"), ElementsAre("6", "7")));
  EXPECT_EQ(csv.rows[0].line, 2u);
  EXPECT_EQ(csv.rows[1].line, 6u);
}

TEST(Csv, BlanksStayInCellsAndGoAroundQuotesAndInHeaders) {
  const Csv csv = parse_csv(" a\t, \" b \" \n 1 , \" 2 \"\t\n", "c");
  EXPECT_THAT(csv.header, ElementsAre("a", "b"));
  EXPECT_THAT(cells_of(csv), ElementsAre(ElementsAre(" 1 ", " 2 ")));
  EXPECT_EQ(csv.number(csv.rows[0], 0, 0, 2, true), 1);
  EXPECT_EQ(csv.number(csv.rows[0], 1, 0, 2, true), 2);
}

TEST(Csv, TheLastCellMayBeEmptyAndTheLastLineWithoutAnEnd) {
  EXPECT_THAT(cells_of(parse_csv("a,b\n1,\n,\n,2", "c")),
              ElementsAre(ElementsAre("1", ""), ElementsAre("", ""), ElementsAre("", "2")));
}

TEST(Csv, WhatIsWrittenReadsBack) {
  const std::vector<std::string> cells = {"#a", "b,c", "\"", "\r", "\n", "", "d e", "\"\"", "f\"g"};
  std::string header = "0";
  for (std::size_t k = 1; k < cells.size(); ++k) header += "," + std::to_string(k);
  EXPECT_THAT(cells_of(parse_csv(header + "\n" + csv_line(cells) + "\n", "c")), ElementsAre(cells));
  EXPECT_EQ(csv_line({"a", "b c", ""}), "a,b c,");
}

TEST(Csv, ColumnsWithoutANameMayBeSeveral) {
  EXPECT_THAT(parse_csv(",a,\n", "c").header, ElementsAre("", "a", ""));
  EXPECT_EQ(test::error_of([] { parse_csv("a, a\n", "c"); }), "c:1: column 'a' comes twice in the header");
}

}  // namespace
}  // namespace sunbeam
