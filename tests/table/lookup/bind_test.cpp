// What binding costs in memory, and that any number of threads may do it.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "sunbeam/table_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

std::vector<double> values_of(const TableBsdf& bsdf) {
  std::vector<double> values;
  Rng rng(1, 0);
  for (int k = 0; k < 100; ++k) {
    const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const auto sample = bsdf.sample(wo, random3(rng));
    if (!sample) continue;
    const EvalPdf at = bsdf.eval_pdf(wo, sample->wi);
    values.insert(values.end(), {sample->wi.x, sample->wi.y, at.f.r, at.f.g, at.f.b, at.pdf});
  }
  return values;
}

// Roughnesses of tables differ, and what depends on them alone is made by whoever comes first.
TEST(Bind, ManyThreadsGetTheSameBits) {
  std::vector<Table> tables;
  for (int k = 0; k < 12; ++k)
    tables.push_back(test::small_factored_table(0.05 + 0.07 * k, AbsorptionPath::sum));
  constexpr int kThreads = 8;
  std::vector<std::vector<std::vector<double>>> found(kThreads);
  std::vector<std::thread> threads;
  for (auto& mine : found)
    threads.emplace_back([&tables, &mine] {
      for (const Table& table : tables) mine.push_back(values_of(table.bind({250, 1.45, 0.1})));
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const std::vector<double> expected = values_of(tables[k].bind({250, 1.45, 0.1}));
    EXPECT_GT(expected.size(), 100u);
    for (const auto& mine : found) EXPECT_EQ(mine[k], expected) << k;
  }
}

TEST(Bind, TakesLittleMemory) {
  const Table table = load_table_exr(std::string(SUNBEAM_SOURCE_DIR) + "/tables/golden/preview.exr");
  EXPECT_LE(table.bind(Parameters::of(table.material)).bytes(), 96000u);
}

TEST(Bind, FailsWithoutAnException) {
  const Table table = test::small_factored_table();
  const Result<TableBsdf> refused = try_bind(table, {5000, 1.45, 0.1});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error(), ::testing::HasSubstr("key 'film_thickness_nm': found 5000"));
  EXPECT_TRUE(try_bind(table, {250, 1.45, 0.1}));
  const Result<TableBsdf> unknown =
      try_bind(table, {std::nan(""), 1.45, 0.1}, {.outside = OutsideGrid::clamp});
  ASSERT_FALSE(unknown) << "what is no number has no nearest point";
  EXPECT_THAT(unknown.error(), ::testing::HasSubstr("key 'film_thickness_nm': found nan"));
  EXPECT_THAT(try_load_table_exr("none.exr").error(), ::testing::HasSubstr("none.exr"));
}

}  // namespace
}  // namespace sunbeam
