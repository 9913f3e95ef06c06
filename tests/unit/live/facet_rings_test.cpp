// Rings of facets as a quadrature over visible normals.
#include "bake/live/exact/facet_rings.h"

#include <gtest/gtest.h>

namespace sunbeam {
namespace {

const std::vector<double> kEdges{0, 0.3, 0.62, 0.9, 0.97, 1};
const FacetRings::Power kUnit = [](double) { return Rgb(1); };
const double kTilts[] = {0, 0.2, 0.8, 1.3, 1.5};

TEST(FacetRings, AllVisibleNormalsWeighOne) {
  for (const Roughness& roughness : {Roughness(0.02), Roughness(0.2), Roughness(1), Roughness(0.1, 0.3),
                                     Roughness(0.031, 0.62), Roughness(0.37, 0.024)})
    for (const double tilt : kTilts) {
      const FacetRings::Rules rules(28);
      const Vec3 w = spherical_direction(tilt, 0.7);
      double sum = 0;
      for (const auto& [normal, weight, power] :
           FacetRings(w, {roughness, 1, 0}, kEdges, rules).crossing(kUnit)) {
        EXPECT_GE(normal.z, -1e-12);
        sum += weight * power.g;
      }
      EXPECT_NEAR(sum, 1, 1e-5) << roughness.u << ' ' << tilt;
    }
}

// A power that oscillates between edges is integrated by itself: what it is multiplied with is smooth.
TEST(FacetRings, PowersAreResolvedBetweenEdges) {
  std::vector<double> edges;
  for (int k = 0; k <= 400; ++k) edges.push_back(k / 400.0);
  const FacetRings::Power fringes = [](double cosine) { return Rgb(1 + std::cos(600 * cosine)); };
  for (const double roughness : {0.05, 0.4})
    for (const double tilt : kTilts) {
      const Vec3 w = spherical_direction(tilt, 0);
      const auto mean = [&](int nodes) {
        const FacetRings::Rules rules(nodes);
        double sum = 0;
        for (const auto& node : FacetRings(w, {roughness, 1, 0}, edges, rules).crossing(fringes))
          sum += node.weight * node.power.g;
        return sum;
      };
      EXPECT_NEAR(mean(28), mean(60), 1e-5) << roughness << ' ' << tilt;
    }
}

// However narrow the lobe of an anisotropic film is.
TEST(FacetRings, MoreNodesChangeNothing) {
  for (const Roughness& roughness : {Roughness(0.2), Roughness(0.1, 0.3), Roughness(0.031, 0.62)})
    for (const double tilt : kTilts) {
      const Vec3 w = spherical_direction(tilt, 0.9);
      const Ggx ggx(roughness);
      const auto mean = [&](int nodes) {
        const FacetRings::Rules rules(nodes);
        double sum = 0;
        for (const auto& node : FacetRings(w, {roughness, 1, 0}, kEdges, rules).mirroring(kUnit)) {
          const Vec3 up = reflect(w, node.normal);
          if (up.z > 0) sum += node.weight * node.power.g * ggx.g2_over_g1(w, up);
        }
        return sum;
      };
      EXPECT_NEAR(mean(28), mean(60), 1e-5) << roughness.u << ' ' << tilt;
    }
}

// Only what leaves above the horizon, and nearly nothing else of a narrow lobe.
TEST(FacetRings, MirroringNormalsLeadUp) {
  const FacetRings::Rules rules(28);
  for (const double roughness : {0.02, 0.4})
    for (const double tilt : kTilts) {
      const Vec3 w = spherical_direction(tilt, 0);
      double sum = 0;
      for (const auto& [normal, weight, power] :
           FacetRings(w, {roughness, 1, 0}, kEdges, rules).mirroring(kUnit)) {
        EXPECT_GE(reflect(w, normal).z, -1e-12);
        sum += weight * power.g;
      }
      EXPECT_LE(sum, 1 + 1e-5);
      EXPECT_GT(sum, roughness < 0.1 && tilt < 1 ? 0.99 : 0.4);
    }
}

// Into a rarer medium light passes up to the critical angle, and not below the horizon of the base.
TEST(FacetRings, CrossingNormalsLetLightIntoARarerBase) {
  const FacetRings::Rules rules(28);
  const double ratio = 1.3, critical = std::sqrt(1 - 1 / square(ratio));
  for (const double tilt : kTilts) {
    const Vec3 w = spherical_direction(tilt, 0);
    for (const auto& [normal, weight, power] :
         FacetRings(w, {0.3, ratio, critical}, kEdges, rules).crossing(kUnit)) {
      const double cosine = dot(w, normal), below2 = 1 - square(ratio) * (1 - square(cosine));
      EXPECT_GE(below2, -1e-12);
      EXPECT_GE(ratio * w.z + (std::sqrt(std::max(0.0, below2)) - ratio * cosine) * normal.z, -1e-9);
    }
  }
}

}  // namespace
}  // namespace sunbeam
