// Bounded visible normals: the density is that of the samples, and few of them are lost below the horizon.
#include <gtest/gtest.h>

#include "sunbeam/bsdf.h"
#include "sunbeam/detail/ggx.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

// A mirror of GGX facets drawn by bounded visible normals, and nothing else: its throughput does not matter.
class BoundedMirror final : public Bsdf {
 public:
  explicit BoundedMirror(const Roughness& roughness) : ggx_(roughness) {}
  Rgb eval(const Vec3&, const Vec3&, Rng&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    const Vec3 wi = ggx_.sample_mirrored(wo, {rng.uniform(), rng.uniform()});
    if (wi.z <= 0) return {};
    return BsdfSample{wi, Rgb(1), false, 0};
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override {
    return ggx_.reflection_pdf_bounded(wo, normalize(wo + wi));
  }

 private:
  Ggx ggx_;
};

const Roughness kRoughness[] = {{0.1, 0.1}, {0.5, 0.5}, {1, 1}, {0.2, 0.6}, {0.7, 0.3}};
const double kAngles[] = {0, 0.7, 1.2, 1.5};  // of wo, radians

// 20 tests, false alarm 1e-3 in all. The smoothest lobe fills but a few of the cells.
TEST(GgxBounded, SamplesFollowTheDensity) {
  for (const Roughness& roughness : kRoughness)
    for (const double angle : kAngles) {
      const auto result =
          test::chi_square_of_sampling(BoundedMirror(roughness), spherical_direction(angle, 0.4),
                                       {.samples = 50000, .pdf_samples = 16}, 1);
      EXPECT_GT(result.p_value, test::sidak(1e-3, 20)) << roughness.u << ":" << roughness.v << ' ' << angle;
      EXPECT_GT(result.degrees, 5) << roughness.u << ":" << roughness.v << ' ' << angle;
    }
}

// Seen at grazing the narrowest lobe takes a finer grid. 20 comparisons at 4.5 standard errors: false alarm
// 20 x 7e-6 in all.
TEST(GgxBounded, IntegratesToOneMinusWhatIsLost) {
  for (const Roughness& roughness : kRoughness)
    for (const double angle : kAngles) {
      const Vec3 wo = spherical_direction(angle, 0.4);
      const BoundedMirror mirror(roughness);
      const auto totals = test::sample_totals(mirror, wo, 100000, 2);
      const auto integral = test::integrate_pdf(mirror, wo, wo.z < 0.2 ? 1200 : 300, 4, 2);
      EXPECT_LT(integral.std_error(), 2e-3) << roughness.u << ":" << roughness.v << ' ' << angle;
      EXPECT_LT(
          test::deviation(totals.seen.mean(), totals.seen.std_error(), integral.mean(), integral.std_error()),
          4.5)
          << roughness.u << ":" << roughness.v << ' ' << angle << ": " << totals.seen.mean() << ' '
          << integral.mean();
    }
}

// With the same numbers the bounded cap ends above the whole one, so that fewer normals mirror downwards: not
// one more in any case.
TEST(GgxBounded, LosesNoMoreThanVisibleNormals) {
  for (const Roughness& roughness : kRoughness) {
    const Ggx ggx(roughness);
    int lost_bounded = 0, lost_visible = 0;
    for (const double angle : kAngles) {
      const Vec3 wo = spherical_direction(angle, 0.4);
      for (int i = 0; i < 100; ++i)
        for (int j = 0; j < 100; ++j) {
          const Point2 u{(i + 0.5) / 100, (j + 0.5) / 100};
          lost_bounded += ggx.sample_mirrored(wo, u).z <= 0;
          lost_visible += reflect(wo, ggx.sample_visible(wo, u)).z <= 0;
        }
    }
    EXPECT_LE(lost_bounded, lost_visible) << roughness.u << ":" << roughness.v;
    if (roughness.u >= 0.5) {
      EXPECT_LT(lost_bounded, 0.9 * lost_visible) << roughness.u;
    }
  }
}

// A shorter cap is a denser one: wherever light can leave, no lobe weighs more than over visible normals.
TEST(GgxBounded, DensityIsNoLessThanOfVisibleNormals) {
  Rng rng(3, 0);
  for (const Roughness& roughness : kRoughness)
    for (int k = 0; k < 2000; ++k) {
      const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      const Vec3 h = normalize(wo + wi);
      const Ggx ggx(roughness);
      EXPECT_GE(ggx.reflection_pdf_bounded(wo, h), ggx.reflection_pdf(wo, h) * (1 - 1e-12));
    }
}

}  // namespace
}  // namespace sunbeam
