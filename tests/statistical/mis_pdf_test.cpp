// The deterministic density that stands in for LiveBsdf::pdf() in MIS weights.
#include <gtest/gtest.h>

#include "bake/live/live_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/configurations.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4);

// The MIS density is no more than a guide, but it must not miss what is there: within a factor of 3 of the
// pdf where the pigment absorbs little, and positive everywhere above the horizon.
TEST(MisPdf, CoversThePdf) {
  for (const auto& [name, material] : test::all_modes()) {
    const LiveBsdf bsdf(material);
    Rng rng(5, 0);
    for (const double theta : {0.05, 0.5, 1.0, 1.4})
      for (const double phi : {0.0, 1.5, 3.0}) {
        const Vec3 wi = spherical_direction(theta, phi);
        test::RunningMean pdf;
        for (int i = 0; i < 2000; ++i) pdf.add(bsdf.pdf(kOblique, wi, rng));
        const double mis = bsdf.mis_pdf(kOblique, wi);
        EXPECT_GT(mis, 0) << name;
        EXPECT_LT(pdf.mean(), 3 * mis + 5 * pdf.std_error()) << name << ' ' << theta << ' ' << phi;
        EXPECT_GT(pdf.mean(), mis / 3 - 5 * pdf.std_error()) << name << ' ' << theta << ' ' << phi;
      }
    EXPECT_GT(bsdf.mis_pdf(kOblique, spherical_direction(1.57, 0)), 0) << name;
  }
}

// In the mirror direction of a nearly smooth film the first surface is some ten times all the rest.
TEST(MisPdf, SeesTheHighlight) {
  for (const auto& [name, material] : test::all_modes(0.02)) {
    const LiveBsdf bsdf(material);
    const Vec3 mirror{-kOblique.x, -kOblique.y, kOblique.z};
    Rng rng(12, 0);
    test::RunningMean pdf;
    for (int i = 0; i < 2000; ++i) pdf.add(bsdf.pdf(kOblique, mirror, rng));
    const double mis = bsdf.mis_pdf(kOblique, mirror);
    EXPECT_LT(pdf.mean(), 1.5 * mis + 5 * pdf.std_error()) << name;
    EXPECT_GT(pdf.mean(), mis / 1.5 - 5 * pdf.std_error()) << name;
    if (!material.is_smooth()) {
      EXPECT_GT(mis, 3) << name;
    }
  }
}

}  // namespace
}  // namespace sunbeam
