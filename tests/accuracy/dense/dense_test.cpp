// What the arrays of a dense table hold.
#include "tests/accuracy/support.h"

namespace sunbeam {
namespace {

// One number a cell, to three binary digits.
TEST(DenseTable, ErrorsAreCoarse) {
  const Table& table = test::baked(test::SmallRecipe());
  ASSERT_EQ(table.rest_stderr.channels(), 1u);
  int exponent = 0;
  for (const float error : table.rest_stderr.values()) {
    EXPECT_GT(error, 0);
    EXPECT_EQ(8 * std::frexp(error, &exponent), std::round(8 * std::frexp(error, &exponent)));
  }
}

}  // namespace
}  // namespace sunbeam
