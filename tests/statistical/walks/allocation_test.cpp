// Calls of the live model do not touch the heap: this program counts every allocation.
#include <gtest/gtest.h>

#include "bake/live/live_bsdf.h"
#include "tests/support/configurations.h"
#include "tests/support/count_allocations.h"

namespace sunbeam {
namespace {

TEST(Allocation, IsCounted) {
  const long before = allocations;
  delete new int(1);
  EXPECT_GE(allocations, before);
  std::vector<double> some(1000);
  EXPECT_GT(allocations, before) << some.size();
}

TEST(Allocation, NoneInACallOfTheLiveModel) {
  const Vec3 wo = spherical_direction(0.3, 0), wi = spherical_direction(1, 2);
  for (const auto& [name, material] : test::every_mode()) {
    const Pfmc pfmc(material, test::twelve_wavelengths(material));
    const LiveBsdf bsdf(material, test::twelve_wavelengths(material));
    Rng rng(16, 0);
    const long before = allocations;
    for (int i = 0; i < 50; ++i) {
      pfmc.estimate_rest(wo, wi, rng, Technique::unidirectional);
      pfmc.estimate_rest(wo, wi, rng, Technique::bidirectional);
      bsdf.eval(wo, wi, rng);
      bsdf.sample(wo, rng);
      bsdf.pdf(wo, wi, rng);
      bsdf.mis_pdf(wo, wi);
    }
    EXPECT_EQ(allocations, before) << name;
  }
}

}  // namespace
}  // namespace sunbeam
