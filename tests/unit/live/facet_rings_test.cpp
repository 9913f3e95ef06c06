// Rings of facets as a quadrature over visible normals.
#include "bake/live/exact/facet_rings.h"

#include <gtest/gtest.h>

namespace sunbeam {
namespace {

const std::vector<double> kEdges{0, 0.3, 0.62, 0.9, 0.97, 1};
const double kTilts[] = {0, 0.2, 0.8, 1.3, 1.5};

TEST(FacetRings, AllVisibleNormalsWeighOne) {
  for (const Roughness& roughness : {Roughness(0.02), Roughness(0.2), Roughness(1), Roughness(0.1, 0.3)})
    for (const double tilt : kTilts) {
      const FacetRings::Rules rules(28, roughness);
      const Vec3 w = spherical_direction(tilt, 0.7);
      double sum = 0;
      for (const auto& [normal, weight] : FacetRings(w, {roughness, 1, 0}, kEdges, rules).crossing()) {
        EXPECT_GE(normal.z, -1e-12);
        sum += weight;
      }
      EXPECT_NEAR(sum, 1, roughness.is_isotropic() ? 1e-5 : 1e-3) << roughness.u << ' ' << tilt;
    }
}

// Only what leaves above the horizon, and nearly nothing else of a narrow lobe.
TEST(FacetRings, MirroringNormalsLeadUp) {
  const FacetRings::Rules rules(28, 0.3);
  for (const double roughness : {0.02, 0.4})
    for (const double tilt : kTilts) {
      const Vec3 w = spherical_direction(tilt, 0);
      double sum = 0;
      for (const auto& [normal, weight] : FacetRings(w, {roughness, 1, 0}, kEdges, rules).mirroring()) {
        EXPECT_GE(reflect(w, normal).z, -1e-12);
        sum += weight;
      }
      EXPECT_LE(sum, 1 + 1e-5);
      EXPECT_GT(sum, roughness < 0.1 && tilt < 1 ? 0.99 : 0.4);
    }
}

// Into a rarer medium light passes up to the critical angle, and not below the horizon of the base.
TEST(FacetRings, CrossingNormalsLetLightIntoARarerBase) {
  const FacetRings::Rules rules(28, 0.3);
  const double ratio = 1.3, critical = std::sqrt(1 - 1 / square(ratio));
  for (const double tilt : kTilts) {
    const Vec3 w = spherical_direction(tilt, 0);
    for (const auto& [normal, weight] : FacetRings(w, {0.3, ratio, critical}, kEdges, rules).crossing()) {
      const double cosine = dot(w, normal), below2 = 1 - square(ratio) * (1 - square(cosine));
      EXPECT_GE(below2, -1e-12);
      EXPECT_GE(ratio * w.z + (std::sqrt(std::max(0.0, below2)) - ratio * cosine) * normal.z, -1e-9);
    }
  }
}

}  // namespace
}  // namespace sunbeam
