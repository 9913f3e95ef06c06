// The same recipe and seed give the same bits whatever the number of threads.
#include "tests/accuracy/factored/support.h"

namespace sunbeam {
namespace {

const std::vector<std::string> kSmallGrid = {"grid.base_ior={from=1.0, to=1.5, count=3}",
                                             "grid.film_thickness_nm=[200, 400]",
                                             "grid.absorption_per_nm=[0, 0.5]", "table.angles=4"};

Table bake(const test::FilmRow& row, int threads, std::uint64_t seed) {
  return bake_table(test::recipe_of(row, "rgb3", kSmallGrid),
                    {.seed = seed, .threads = threads, .on_progress = {}});
}

TEST(FactoredBits, DoNotDependOnThreads) {
  for (const test::FilmRow& row : test::all_rows()) {
    const Table one = bake(row, 1, 7);
    EXPECT_TRUE(bake(row, 2, 7) == one) << row.name();
    EXPECT_TRUE(bake(row, 0, 7) == one) << row.name();
  }
}

TEST(FactoredBits, DependOnTheSeed) {
  for (const test::FilmRow& row : test::all_rows())
    EXPECT_FALSE(bake(row, 0, 7).factors == bake(row, 0, 8).factors) << row.name();
}

}  // namespace
}  // namespace sunbeam
