// What crosses the facets of one cosine, against drawn legs.
#include "bake/factored/facets/crossing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "bake/factored/legs.h"
#include "sunbeam/detail/refraction.h"
#include "tests/unit/factored/facets/binned_power.h"

namespace sunbeam {
namespace {

using test::kBins, test::kDepths;

struct Surface {
  std::string name;
  Material material;
};

Material bending(const Roughness& roughness, double exterior_ior, double base_ior) {
  Material m;
  m.roughness = roughness;
  m.exterior_ior = exterior_ior;
  m.base_ior = base_ior;
  return m;
}

Material straight(const Roughness& roughness) {
  Material m = bending(roughness, 1, 1.5);
  m.transmission = Transmission::straight;
  return m;
}

// Denser and rarer bases, those of the exterior's index, and facets that do not bend light.
std::vector<Surface> surfaces() {
  std::vector<Surface> result;
  for (const Roughness& roughness : {Roughness(0.05), Roughness(0.4), Roughness(0.1, 0.35)}) {
    const std::string name = std::to_string(roughness.u) + " " + std::to_string(roughness.v);
    result.push_back({name + " denser", bending(roughness, 1, 1.5)});
    result.push_back({name + " rarer", bending(roughness, 1.4, 1.2)});
    result.push_back({name + " equal", bending(roughness, 1.4, 1.4)});
    result.push_back({name + " straight", straight(roughness)});
  }
  return result;
}

// A(w) of each bin, for a film that lets everything through.
std::vector<double> crossing_power(const Material& material, const VisibleFacets& facets,
                                   const test::BinnedRanks& ranks) {
  const auto values = crossing_values(material, facets, facets.cosines(ranks.nodes), kDepths);
  const double per_m = 1 / crossing_cosine(material, facets.w().z);
  return ranks.sums([&](std::size_t t, std::size_t j) {
    return std::exp(values[t * ranks.nodes.size() + j] - kDepths[t] * per_m);
  });
}

test::DrawnPower drawn_power(const Material& material, const Vec3& w, const std::vector<double>& edges) {
  const FilmLegs legs(material);
  return test::DrawnPower([&](std::size_t run, std::vector<double>& power) {
    legs.visit_arrivals(w, 64, Rng(5, run), [&](const Leg& leg) {
      for (std::size_t t = 0; t < kDepths.size(); ++t)
        power[t * kBins + test::bin_of(edges, leg.facet_cosine)] +=
            leg.weight * std::exp(-kDepths[t] / leg.to);
    });
  });
}

double critical_of(const Material& m) {
  return m.transmission == Transmission::straight ? 0 : critical_cosine(m.exterior_ior, m.base_ior);
}

// Beyond the critical angle nothing is drawn. 864 scores: false alarm 0.1 % in all.
TEST(Crossing, IsThatOfDrawnLegs) {
  const test::BinnedRanks ranks;
  for (const auto& [name, material] : surfaces())
    for (const double tilt : {0.0, 0.5, 1.2, 1.5}) {
      const Vec3 w = spherical_direction(tilt, 0.6);
      const VisibleFacets facets(w, material.roughness, bending_index_ratio(material));
      const std::vector<double> edges = facets.cosines(ranks.edges);
      const auto expected = crossing_power(material, facets, ranks);
      const test::DrawnPower drawn = drawn_power(material, facets.w(), edges);
      for (std::size_t bin = 0; bin < kBins; ++bin)
        for (std::size_t t = 0; t < kDepths.size(); ++t) {
          if (edges[bin] >= critical_of(material))
            drawn.expect(t, bin, expected[t * kBins + bin], name + " " + std::to_string(tilt));
          if (edges[bin + 1] < critical_of(material)) {
            EXPECT_EQ(drawn.mean(t, bin), 0) << name << ' ' << tilt;
          }
        }
    }
}

// There the values are those at the critical angle, so that a cubic through them is smooth.
TEST(Crossing, GoesOnBeyondTheCriticalAngle) {
  const Material material = bending(0.3, 1.4, 1.2);
  const VisibleFacets facets(spherical_direction(0.9, 0), material.roughness, bending_index_ratio(material));
  const double critical = std::sqrt(1 - square(1.2 / 1.4));
  const std::vector<double> cosines{0, critical / 2, critical, critical + 0.05};
  const auto values = crossing_values(material, facets, cosines, kDepths);
  for (std::size_t t = 0; t < kDepths.size(); ++t) {
    const double* at = &values[t * cosines.size()];
    EXPECT_NEAR(at[0], at[2], 1e-9);
    EXPECT_NEAR(at[1], at[2], 1e-9);
    EXPECT_GT(std::abs(at[3] - at[2]), 0.01);
  }
}

}  // namespace
}  // namespace sunbeam
