// How light from the base meets facets from below, and what they send back, against drawn legs.
#include "bake/factored/facets/returning.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bake/factored/legs.h"
#include "tests/unit/factored/facets/binned_power.h"

namespace sunbeam {
namespace {

using test::kBins, test::kDepths;

constexpr int kDraws = 100000;

// Facets mirror light whether they bend it or not.
Material material_of(const Roughness& roughness) {
  Material m;
  m.roughness = roughness;
  return m;
}

const std::vector<Roughness>& roughnesses() {
  static const std::vector<Roughness> all{0.03, 0.1, 0.4, 1, {0.4, 0.2}};
  return all;
}

// The cosines at the edges of bins, and the power of each bin for a film that reflects everything.
struct Expected {
  std::vector<double> edges, power;
};

// One call for edges and nodes: that of an anisotropic film takes seconds.
Expected expected_of(const Material& material) {
  const test::BinnedRanks ranks;
  std::vector<double> all = ranks.edges;
  all.insert(all.end(), ranks.nodes.begin(), ranks.nodes.end());
  const Returning found = returning_of(material, all, kDepths);
  const std::size_t edges = ranks.edges.size();
  return {{found.cosines.begin(), found.cosines.begin() + std::ptrdiff_t(edges)},
          ranks.sums([&](std::size_t t, std::size_t j) { return found.values[t * all.size() + edges + j]; })};
}

test::DrawnPower drawn_power(const Material& material, const std::vector<double>& edges) {
  const FilmLegs legs(material);
  return test::DrawnPower([&](std::size_t run, std::vector<double>& power) {
    legs.visit_returns(32, Rng(6, run), [&](const Leg& leg) {
      for (std::size_t t = 0; t < kDepths.size(); ++t)
        power[t * kBins + test::bin_of(edges, leg.facet_cosine)] +=
            leg.weight * std::exp(-kDepths[t] * (1 / leg.from + 1 / leg.to));
    });
  });
}

// Facets that light along the base's cosine law meets, by the bin of their cosine. Their number is fixed, so
// that the p-value is too high, if anything.
double p_value_of_bins(const Material& material, const std::vector<double>& edges) {
  const test::BinnedRanks ranks;
  std::vector<test::Cell> cells;
  for (std::size_t bin = 0; bin < kBins; ++bin)
    cells.push_back({0, kDraws * (share_of_rank(ranks.edges[bin + 1]) - share_of_rank(ranks.edges[bin]))});
  Rng rng(7, 0);
  const Ggx ggx(material.roughness);
  for (int i = 0; i < kDraws; ++i) {
    const double cosine = std::sqrt(1 - rng.uniform()), phi = 2 * kPi * rng.uniform();
    const Vec3 m = direction_from_cosine(cosine, phi);
    const double u = rng.uniform(), v = rng.uniform();
    ++cells[test::bin_of(edges, dot(m, ggx.sample_visible(m, {u, v})))].observed;
  }
  return test::chi_square(cells).p_value;
}

// 90 scores and 5 tests: false alarm 1.1e-3 in all.
TEST(Returning, IsThatOfDrawnLegs) {
  for (const Roughness& roughness : roughnesses()) {
    const Material material = material_of(roughness);
    const std::string name = std::to_string(roughness.u) + " " + std::to_string(roughness.v);
    const Expected expected = expected_of(material);
    EXPECT_GT(p_value_of_bins(material, expected.edges), test::sidak(1e-3, int(roughnesses().size())))
        << name;
    const test::DrawnPower drawn = drawn_power(material, expected.edges);
    for (std::size_t bin = 0; bin < kBins; ++bin)
      for (std::size_t t = 0; t < kDepths.size(); ++t)
        drawn.expect(t, bin, expected.power[t * kBins + bin], name);
  }
}

// Under a smooth film light comes back at the cosine that it left by, and the share below it is its square.
TEST(Returning, OfASmoothFilmIsInClosedForm) {
  const std::vector<double>& ranks = test::BinnedRanks().nodes;
  const Returning found = returning_of(material_of(0), ranks, kDepths);
  for (std::size_t j = 0; j < ranks.size(); ++j) {
    EXPECT_NEAR(square(found.cosines[j]), share_of_rank(ranks[j]), 1e-12);
    for (std::size_t t = 0; t < kDepths.size(); ++t)
      EXPECT_NEAR(found.values[t * ranks.size() + j], std::exp(-2 * kDepths[t] / found.cosines[j]), 1e-12);
  }
}

}  // namespace
}  // namespace sunbeam
