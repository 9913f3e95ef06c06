#include "bake/live/base.h"

#include <gtest/gtest.h>

#include "tests/support/quadrature.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

Material material(AbsorptionPath path, double optical_depth) {
  Material m;
  m.absorption_path = path;
  m.pigment_thickness_nm = 2;
  m.absorption_per_nm = optical_depth / 2;
  m.albedo = {0.9, 0.5, 0.1};
  return m;
}

const AbsorptionPath kPaths[] = {AbsorptionPath::product, AbsorptionPath::sum};
const double kDepths[] = {0, 0.3, 3};

// tau = 1 and cosines 1/2, 1/2: product exp(-4), sum exp(-4); cosines 1/2, 1: product exp(-2), sum exp(-3).
TEST(PigmentedBase, ValueByHand) {
  const PigmentedBase product(material(AbsorptionPath::product, 1)), sum(material(AbsorptionPath::sum, 1));
  EXPECT_NEAR(product.value(0.5, 0.5).r, 0.9 / kPi * std::exp(-4), 1e-16);
  EXPECT_NEAR(sum.value(0.5, 0.5).g, 0.5 / kPi * std::exp(-4), 1e-16);
  EXPECT_NEAR(product.value(0.5, 1).r, 0.9 / kPi * std::exp(-2), 1e-16);
  EXPECT_NEAR(sum.value(1, 0.5).r, 0.9 / kPi * std::exp(-3), 1e-16);
}

TEST(PigmentedBase, NoPigmentIsLambert) {
  for (const auto path : kPaths)
    EXPECT_NEAR(PigmentedBase(material(path, 0)).value(0.01, 0.7).r, 0.9 / kPi, 1e-16);
}

TEST(PigmentedBase, DensityIntegratesToOne) {
  for (const auto path : kPaths)
    for (const double depth : kDepths)
      for (const double cos_in : {0.05, 0.5, 1.0}) {
        const PigmentedBase base(material(path, depth));
        const double total =
            test::integrate(0, 1, 200, [&](double mu) { return 2 * kPi * base.density(cos_in, mu); });
        EXPECT_NEAR(total, 1, 1e-8);
      }
}

// weight = f1 cos / density, and never above the bound of the header: 2 albedo / (2 + a) exp(-a), where the
// sum path has its arriving leg exp(-tau / cos_in) besides.
TEST(PigmentedBase, WeightIsValueOverDensityAndBounded) {
  Rng rng(1, 0);
  for (const auto path : kPaths)
    for (const double depth : kDepths)
      for (const double cos_in : {0.05, 0.5, 1.0}) {
        const PigmentedBase base(material(path, depth));
        const bool is_product = path == AbsorptionPath::product;
        const double a = is_product ? depth / cos_in : depth;
        const double bound = 2 * 0.9 / (2 + a) * std::exp(-a) * (is_product ? 1 : std::exp(-depth / cos_in));
        for (int i = 0; i < 50; ++i) {
          const auto s = base.sample(cos_in, rng);
          EXPECT_NEAR(length(s.direction), 1, 1e-12);
          EXPECT_NEAR(s.density / base.density(cos_in, s.direction.z), 1, 1e-12);
          const Rgb expected = base.value(cos_in, s.direction.z) * (s.direction.z / s.density);
          EXPECT_NEAR(s.weight.r, expected.r, 1e-12 * expected.r);
          EXPECT_NEAR(s.weight.b, expected.b, 1e-12 * expected.b);
          EXPECT_LE(s.weight.r, bound * (1 + 1e-9));
        }
      }
}

// P(cos < c) = c^(2 + a): 40 equal-probability cells of it. 18 tests, false alarm 1e-4 in all.
TEST(PigmentedBase, SamplesFollowTheDensity) {
  constexpr int kCells = 40, kSamples = 20000;
  for (const auto path : kPaths)
    for (const double depth : kDepths)
      for (const double cos_in : {0.05, 0.5, 1.0}) {
        const PigmentedBase base(material(path, depth));
        const double a = path == AbsorptionPath::product ? depth / cos_in : depth;
        std::vector<test::Cell> cells(kCells);
        for (auto& cell : cells) cell.expected = static_cast<double>(kSamples) / kCells;
        Rng rng(2, 0);
        for (int i = 0; i < kSamples; ++i) {
          const double share = std::pow(base.sample(cos_in, rng).direction.z, 2 + a);
          cells[std::min(kCells - 1, static_cast<int>(share * kCells))].observed += 1;
        }
        EXPECT_GT(test::chi_square(cells).p_value, test::sidak(1e-4, 18));
      }
}

// E[weight] = Int f1 cos = 2 pi Int f1 mu dmu. 5 standard errors: 6e-7 each.
TEST(PigmentedBase, MeanWeightIsTheAlbedo) {
  for (const auto path : kPaths)
    for (const double depth : kDepths) {
      const PigmentedBase base(material(path, depth));
      const double expected =
          test::integrate(0, 1, 100, [&](double mu) { return 2 * kPi * base.value(0.6, mu).r * mu; });
      Rng rng(3, 0);
      test::RunningMean mean;
      for (int i = 0; i < 20000; ++i) mean.add(base.sample(0.6, rng).weight.r);
      EXPECT_NEAR(mean.mean(), expected, 5 * mean.std_error() + 1e-12);
    }
}

// Extreme absorption: the lobe is a needle and the weight underflows, but nothing becomes NaN.
TEST(PigmentedBase, ExtremeAbsorptionStaysFinite) {
  Rng rng(4, 0);
  for (const auto path : kPaths) {
    const PigmentedBase base(material(path, 1e6));
    for (const double cos_in : {1e-9, 0.5, 1.0})
      for (int i = 0; i < 20; ++i) {
        const auto s = base.sample(cos_in, rng);
        EXPECT_TRUE(is_finite(s.weight));
        EXPECT_GT(s.density, 0);
        EXPECT_LT(s.weight.r, 1e-300);
      }
  }
}

}  // namespace
}  // namespace sunbeam
