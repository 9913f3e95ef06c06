// The yardstick of bare slabs by itself: published values, conservation, convergence, limits by hand.
#include "tests/support/adding_doubling.h"

#include <gtest/gtest.h>

namespace sunbeam {
namespace {

using test::AddingDoubling;

TEST(AddingDoubling, GaussRuleIntegratesPowers) {
  const auto rule = test::half_range_gauss(8);
  for (int power = 0; power < 16; ++power) {
    double sum = 0;
    for (std::size_t i = 0; i < 8; ++i) sum += rule.weights[i] * std::pow(rule.nodes[i], power);
    EXPECT_NEAR(sum, 1.0 / (power + 1), 1e-14) << power;
  }
}

// Van de Hulst 1980, as quoted by Wang, Jacques, Zheng 1995 (MCML): optical thickness 2, albedo 0.9, g 0.75,
// normal incidence. Five digits.
TEST(AddingDoubling, PublishedValues) {
  const AddingDoubling slab(2, 0.9, 0.75, {1});
  EXPECT_NEAR(slab.reflectance(0), 0.09739, 1e-5);
  EXPECT_NEAR(slab.transmittance(0), 0.66096, 1e-5);
}

// A half-space with isotropic scattering, albedo a: R(mu) = 1 - sqrt(1 - a) H(mu) (Chandrasekhar 1950).
// H(mu) = 1 + (a / 2) mu H(mu) Int_0^1 H(m) / (mu + m) dm by iteration. Thickness 60 is as good as infinite.
TEST(AddingDoubling, HalfSpaceByChandrasekhar) {
  constexpr double kAlbedo = 0.8;
  const auto rule = test::half_range_gauss(64);
  const std::vector<double> cosines{0.2, 0.6, 1};
  std::vector<double> h(64, 1.0);
  const auto next = [&](double mu) {
    double sum = 0;
    for (std::size_t i = 0; i < 64; ++i) sum += rule.weights[i] * rule.nodes[i] * h[i] / (mu + rule.nodes[i]);
    return 1 / (std::sqrt(1 - kAlbedo) + kAlbedo / 2 * sum);  // the same equation by its moment
  };
  for (int step = 0; step < 200; ++step)
    for (std::size_t i = 0; i < 64; ++i) h[i] = next(rule.nodes[i]);
  const AddingDoubling slab(60, kAlbedo, 0, cosines);
  for (std::size_t k = 0; k < cosines.size(); ++k)
    EXPECT_NEAR(slab.reflectance(k), 1 - std::sqrt(1 - kAlbedo) * next(cosines[k]), 1e-6) << cosines[k];
}

TEST(AddingDoubling, NoScatteringIsBeersLaw) {
  const AddingDoubling slab(0.7, 0, 0.5, {0.3, 1});
  EXPECT_NEAR(slab.transmittance(0), std::exp(-0.7 / 0.3), 1e-6);
  EXPECT_NEAR(slab.transmittance(1), std::exp(-0.7), 1e-6);
  EXPECT_NEAR(slab.reflectance(0), 0, 1e-15);
}

TEST(AddingDoubling, WhiteSlabLosesNothing) {
  for (const double thickness : {0.1, 1.0, 10.0})
    for (const double g : {-0.5, 0.0, 0.75, 0.95}) {
      const AddingDoubling slab(thickness, 1, g, {0.1, 0.6, 1});
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(slab.reflectance(k) + slab.transmittance(k), 1, 1e-5) << thickness << ' ' << g;
        EXPECT_NEAR(slab.reflectance_over(1, k), 1, 1e-5) << thickness << ' ' << g;
      }
    }
}

// 32 nodes against 64; strong forward peaks are the hard case.
TEST(AddingDoubling, NodesConverge) {
  for (const double g : {0.0, 0.5, 0.9})
    for (const double thickness : {0.1, 1.0, 5.0}) {
      const std::vector<double> cosines{0.2, 0.7, 1};
      const AddingDoubling coarse(thickness, 0.9, g, cosines, 32), fine(thickness, 0.9, g, cosines, 64);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(coarse.reflectance(k), fine.reflectance(k), 2e-6) << g << ' ' << thickness;
        EXPECT_NEAR(coarse.transmittance(k), fine.transmittance(k), 2e-6) << g << ' ' << thickness;
      }
    }
}

}  // namespace
}  // namespace sunbeam
