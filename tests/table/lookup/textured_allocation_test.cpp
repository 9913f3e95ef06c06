// Look-ups of textured parameters do not touch the heap: this program counts every allocation.
#include <gtest/gtest.h>

#include "sunbeam/textured_table.h"
#include "tests/support/count_allocations.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

std::vector<Table> tables_of_every_kind() {
  std::vector<Table> tables = test::factored_tables();
  for (const bool rough : {false, true}) tables.push_back(test::small_table(Precision::half_float, rough));
  tables.push_back(test::small_anisotropic_table());
  tables.push_back(test::small_full_table());
  return tables;
}

// Whatever the content, look-ups are finite.
TEST(TexturedAllocation, NoneInACall) {
  Rng rng(17, 0);
  for (const Table& table : tables_of_every_kind()) {
    const TexturedTable textured(table);
    for (int k = 0; k < 50; ++k) {
      const Parameters parameters{200 + 200 * rng.uniform(), 1.4 + 0.1 * rng.uniform(), 0.1 * rng.uniform()};
      const Vec3 wo = direction_from_cosine(1 - rng.uniform(), 7 * rng.uniform()),
                 wi = direction_from_cosine(1 - rng.uniform(), 7 * rng.uniform());
      const long before = allocations;
      const TexturedTable::At bsdf = textured.at(parameters);
      const EvalPdf at = bsdf.eval_pdf(wo, wi);
      const auto sample = bsdf.sample(wo, rng);
      const double reflected = bsdf.albedo(wo) + mean(bsdf.dirac(wo));
      EXPECT_EQ(allocations, before);
      EXPECT_TRUE(std::isfinite(mean(at.f) + at.pdf + reflected));
      EXPECT_TRUE(!sample || std::isfinite(mean(sample->throughput)));
    }
  }
}

}  // namespace
}  // namespace sunbeam
