// Multiple facets: the packet walk of the base part and the walk within the microsurface against the general
// stack. All seeds are fixed; the stated false-alarm rates hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/pfmc.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/materials.h"

namespace sunbeam {
namespace {

std::vector<test::NamedMaterial> materials(double roughness, double optical_depth) {
  std::vector<test::NamedMaterial> result;
  for (auto& named : test::all_modes(roughness, optical_depth)) {
    if (named.material.is_smooth()) continue;
    named.material.microfacet = Microfacet::multiple;
    named.name += " " + to_string(named.material.roughness);
    result.push_back(named);
  }
  return result;
}

// What Pfmc does not use for these materials.
class General {
 public:
  explicit General(const Material& material)
      : layers_(material, Wavelengths::rgb3(material)),
        stack_(material),
        walks_(layers_, stack_, importance_, walk::best_kernels()) {}

  Rgb estimate(const Vec3& wo, const Vec3& wi, Rng& rng) const {
    double sums[3] = {};
    walks_.add_unidirectional(wi, &wo, 1, rng, sums);
    return {sums[0], sums[1], sums[2]};
  }

 private:
  static constexpr double importance_[3] = {1 / 3.0, 1 / 3.0, 1 / 3.0};
  walk::Layers layers_;
  walk::GeneralLayers stack_;
  walk::GeneralWalk walks_;
};

void expect_agreement(const std::string& name, const Material& material, double angle_o, double angle_i) {
  const Pfmc pfmc(material);
  const General general(material);
  const Vec3 wo = spherical_direction(angle_o, 0), wi = spherical_direction(angle_i, 2);
  test::RgbMean found, expected;
  Rng rng(21, 0), other(21, 1);
  for (int i = 0; i < 60000; ++i) {
    found.add(pfmc.estimate_rest(wo, wi, rng));
    expected.add(general.estimate(wo, wi, other));
  }
  for (int c = 0; c < 3; ++c) {
    const double error = std::hypot(found[c].std_error(), expected[c].std_error());
    EXPECT_NEAR(found[c].mean(), expected[c].mean(), 4.5 * error) << name << ", channel " << c;
    EXPECT_LE(error, 3e-3 * expected[c].mean()) << name << ", channel " << c;
  }
}

// 3 roughnesses x 4 modes x 2 pairs x 3 channels at 4.5 standard errors: 5e-4.
TEST(FacetsWalk, AgreesWithTheGeneralStack) {
  for (const double roughness : {0.05, 0.3, 1.0})
    for (const auto& [name, material] : materials(roughness, 0.1)) {
      expect_agreement(name, material, 0.8, 0.5);
      expect_agreement(name, material, 0.3, 1.1);
    }
}

// Media that total reflection separates on either side, and a bare boundary: 3 x 3 tests.
TEST(FacetsWalk, AgreesInEveryOrderOfIndices) {
  Material m = materials(0.5, 0.2)[3].material;
  m.base_ior = 2;
  expect_agreement("dense base", m, 0.8, 0.5);
  m.base_ior = 1;
  expect_agreement("matched base", m, 0.8, 0.5);
  m.film_thickness_nm = 0;
  m.exterior_ior = 1.3;
  m.film_ior = m.base_ior = 1.1;
  expect_agreement("dense exterior", m, 0.3, 0.5);
}

// No rounding is left to the instruction set.
TEST(FacetsWalk, EveryInstructionSetGivesTheSameBits) {
  const Vec3 wi = spherical_direction(0.9, 0);
  const Vec3 wo[] = {spherical_direction(0.1, 1), spherical_direction(1.2, 2)};
  for (const auto& [name, material] : materials(0.3, 0.1))
    for (const auto& wavelengths : {Wavelengths::rgb3(material), test::twelve_wavelengths(material)}) {
      const Pfmc best(material, wavelengths);
      const Pfmc baseline(material, wavelengths, walk::kBaselineKernels);
      Rng rng(22, 0), other(22, 0);
      Rgb found[2], expected[2];
      for (int i = 0; i < 200; ++i) {
        best.add_rest(wi, wo, rng, found);
        baseline.add_rest(wi, wo, other, expected);
      }
      for (int k = 0; k < 2; ++k) EXPECT_EQ(found[k], expected[k]) << name;
    }
}

// Nothing is absorbed: what a white base and the film send back adds up to what came. Directions are drawn
// uniformly over cos^2; 4 tests at 4.5 standard errors.
TEST(FacetsWalk, LosesNothing) {
  for (const double roughness : {0.3, 1.0})
    for (auto& [name, material] : materials(roughness, 0)) {
      if (material.absorption_path == AbsorptionPath::product) continue;
      material.albedo = Rgb(1);
      material.base_ior = 1.4;
      const Pfmc pfmc(material);
      const Vec3 wi = spherical_direction(0.7, 0);
      test::RunningMean albedo;
      Rng rng(23, 0);
      for (int i = 0; i < 60000; ++i) {
        const Vec3 wo = spherical_direction(std::acos(std::sqrt(1 - rng.uniform())), 2 * kPi * rng.uniform());
        // The first surface by its own density, the rest by cosines.
        const Ggx ggx(material.roughness);
        const Vec3 mirrored = reflect(wi, ggx.sample_visible(wi, {rng.uniform(), rng.uniform()}));
        double value = kPi * pfmc.estimate_rest(wo, wi, rng).g;
        if (mirrored.z > 0)
          value += pfmc.first(mirrored, wi).g * mirrored.z / ggx.reflection_pdf(wi, normalize(wi + mirrored));
        albedo.add(value);
      }
      EXPECT_NEAR(albedo.mean(), 1, 4.5 * albedo.std_error()) << name;
      EXPECT_LE(albedo.std_error(), 3e-3) << name;
    }
}

}  // namespace
}  // namespace sunbeam
