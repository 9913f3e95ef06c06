// The weights of bidirectional connections add up to one: over bright bases below rough films, where many
// techniques share a path, the estimate is the exact one.
#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "bake/live/pfmc.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

// 4 tests at 4.5 standard errors: false alarm 3e-5. Quadrature is good to 1e-4.
TEST(BidirectionalWeights, AddUpToOne) {
  const Vec3 wo = spherical_direction(1.2, 0), wi = spherical_direction(0.3, 2);
  for (const Transmission transmission : {Transmission::straight, Transmission::refract})
    for (const double roughness : {0.1, 0.3}) {
      Material m;
      m.transmission = transmission;
      m.roughness = roughness;
      m.albedo = Rgb(0.95);
      m.film_ior = 2;
      m.base_ior = 1.5;
      m.absorption_per_nm = 0.02;
      const double expected = mean(ExactRest(m, Wavelengths::rgb3(m)).rest(wo, wi));
      const Pfmc pfmc(m);
      Rng rng(21, 0);
      test::RunningMean found;
      for (int k = 0; k < 100000; ++k)
        found.add(mean(pfmc.estimate_rest(wo, wi, rng, Technique::bidirectional)));
      EXPECT_NEAR(found.mean(), expected, 4.5 * found.std_error() + 1e-4 * expected)
          << to_string(transmission) << ' ' << roughness;
    }
}

}  // namespace
}  // namespace sunbeam
