// How the facets visible from a direction are spread over their cosine with it.
#include "bake/factored/facets/facet_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sunbeam/core/rng.h"
#include "sunbeam/detail/factors.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

// Simpson's rule and cubics are exact for this one: the share of [0, 2] below x is (x / 2)^3.
TEST(ShareOfInterval, OfAParabolaIsExact) {
  for (const double scale : {1.0, 1e-7}) {
    const ShareOfInterval share_of(0, 2, 5, [&](double x) { return scale * x * x; });
    for (const double share : {0.0, 1e-3, 0.2, 0.5, 0.777, 0.999})
      EXPECT_NEAR(share_of.above(share), 2 * std::cbrt(1 - share), 1e-9) << share;
  }
}

// The share of [-1, 3] above x of a density exp(-x).
TEST(ShareOfInterval, OfAnExponentialIsNear) {
  const ShareOfInterval share_of(-1, 3, 64, [](double x) { return std::exp(-x); });
  for (const double share : {1e-6, 0.01, 0.3, 0.5, 0.9, 1.0}) {
    const double expected = -std::log(std::exp(-3.0) + share * (std::exp(1.0) - std::exp(-3.0)));
    EXPECT_NEAR(share_of.above(share), expected, 1e-5) << share;
  }
}

// The share above any x of an empty stretch is the same.
TEST(ShareOfInterval, PassesOverWhatIsEmpty) {
  const ShareOfInterval share_of(0, 4, 128, [](double x) { return std::max(1 - std::abs(x - 2), 0.0); });
  EXPECT_NEAR(share_of.above(0.5), 2, 1e-9);
  EXPECT_NEAR(share_of.above(0.125), 2.5, 1e-3);
  EXPECT_NEAR(share_of.above(1 - 1e-9), 1, 1e-2);
  EXPECT_GE(share_of.above(0), 3);
  EXPECT_LE(share_of.above(1), 1);
}

constexpr int kCells = 20;

// Ranks up to which a 20th, two 20ths, ... of the facets lie.
std::vector<double> even_ranks() {
  std::vector<double> ranks;
  for (int j = 0; j <= kCells; ++j) {
    const double share = double(j) / kCells, low = std::cbrt(share), high = std::cbrt(1 - share);
    ranks.push_back(low / (low + high));
  }
  return ranks;
}

struct Seen {
  Roughness roughness;
  Vec3 w;
};

std::vector<Seen> all_seen() {
  std::vector<Seen> result;
  for (const Roughness& roughness :
       {Roughness(0.03), Roughness(0.3), Roughness(1), Roughness(0.1, 0.3), Roughness(0.4, 0.05)})
    for (const double tilt : {0.0, 0.5, 1.2, 1.5})
      result.push_back({roughness, spherical_direction(tilt, 0.6)});
  return result;
}

TEST(VisibleFacets, EvenRanksHoldEvenShares) {
  const std::vector<double> ranks = even_ranks();
  for (int j = 0; j <= kCells; ++j) EXPECT_NEAR(share_of_rank(ranks[j]), double(j) / kCells, 1e-12);
}

// Drawn normals fall evenly between the cosines at even ranks. The number of normals is fixed, so that a
// false alarm is rarer than the stated 1e-3 for all 20 directions.
TEST(VisibleFacets, CosinesAreThoseOfDrawnNormals) {
  constexpr int kDraws = 100000;
  const std::vector<Seen> all = all_seen();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& [roughness, w] = all[k];
    const std::vector<double> edges = VisibleFacets(w, roughness, 1).cosines(even_ranks());
    std::vector<test::Cell> cells(kCells, {0, double(kDraws) / kCells});
    Rng rng(3, k);
    const Ggx ggx(roughness);
    for (int i = 0; i < kDraws; ++i) {
      const double u = rng.uniform(), v = rng.uniform();
      const double cosine = dot(w, ggx.sample_visible(w, {u, v}));
      const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, cosine);
      ++cells[static_cast<std::size_t>(above - edges.begin()) - 1].observed;
    }
    EXPECT_GT(test::chi_square(cells).p_value, test::sidak(1e-3, static_cast<int>(all.size())))
        << roughness.u << ' ' << roughness.v << ' ' << w.z;
  }
}

TEST(VisibleFacets, CosinesAscendAndReachTheEnds) {
  for (const auto& [roughness, w] : all_seen()) {
    const std::vector<double> edges = VisibleFacets(w, roughness, 1).cosines(even_ranks());
    EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
    EXPECT_NEAR(edges.front(), 0, 1e-4);
    EXPECT_NEAR(edges.back(), 1, 1e-4);
  }
}

// The azimuth of light tells only under an anisotropic film.
TEST(VisibleFacets, OfAnIsotropicFilmKnowNoAzimuth) {
  const auto cosines = [](double phi, const Roughness& roughness) {
    return VisibleFacets(spherical_direction(1, phi), roughness, 1).cosines(even_ranks());
  };
  EXPECT_EQ(cosines(0, 0.3), cosines(1.3, 0.3));
  const auto along = cosines(0, {0.1, 0.4}), across = cosines(1.3, {0.1, 0.4});
  EXPECT_GT(std::abs(along[kCells / 2] - across[kCells / 2]), 0.02);
}

// Int density(angle) dangle over all angles.
TEST(VisibleFacets, DensityIntegratesToOne) {
  const GaussRule rule = gauss_legendre(400);
  for (const auto& [roughness, w] : all_seen()) {
    const VisibleFacets facets(w, roughness, 1);
    double sum = 0;
    for (int i = 0; i < rule.size(); ++i)
      sum += rule.weight[i] * kPi / 2 * facets.density(rule.node[i] * kPi / 2);
    EXPECT_NEAR(sum, 1, 1e-3) << roughness.u << ' ' << roughness.v << ' ' << w.z;
  }
}

}  // namespace
}  // namespace sunbeam
