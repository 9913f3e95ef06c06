// What a dense table keeps of the noise of its nodes.
#include "bake/dense/nodes.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace sunbeam
