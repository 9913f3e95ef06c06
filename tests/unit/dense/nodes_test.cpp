// What a dense table keeps of the noise of its nodes.
#include "bake/dense/nodes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bake/dense/equal_cells.h"

namespace sunbeam {
namespace {

// Three binary digits, to the nearest: a sixteenth of the power of two above, either way. A cell that no
// other equals keeps its own error.
TEST(DenseNodes, NoiseIsRoundedToThreeDigits) {
  const DenseNodes nodes(
      parse_recipe("[material]\nroughness = 0.2\n[table]\nencoding = \"dense\"\nangles = 4\n", "r"));
  const auto stored = [&](double error) {
    const Rows errors(nodes.wi().size(), std::vector<Rgb>(nodes.wo().size(), Rgb(error)));
    return double{nodes.rest_stderr(errors).front()};
  };
  EXPECT_EQ(stored(0), 0);
  EXPECT_EQ(stored(0.5), 0.5);
  EXPECT_EQ(stored(0.57), 0.625);
  EXPECT_EQ(stored(0.55), 0.5);
  EXPECT_EQ(stored(0.95), 1);
  EXPECT_EQ(stored(0.9 / 1024), 0.875 / 1024);
}

// Two cosines, of which the second is the pole, and three azimuths. A pair with the pole stands in two rows,
// three times in each; a row shares its walks, so that its three errors are one, and the mean of two rows has
// 1 / sqrt 2.
TEST(EqualCells, ErrorsOfOneRowDoNotAverageOut) {
  Rows errors(2, std::vector<Rgb>(6, Rgb(1)));
  EqualCells(true, 2, 3).average_errors(errors);
  EXPECT_NEAR(errors[1][0].g, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(errors[0][3].g, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(errors[0][0].g, 1, 1e-12);  // its own reciprocal
}

}  // namespace
}  // namespace sunbeam
