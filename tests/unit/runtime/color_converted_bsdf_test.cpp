// The adaptor changes colours and nothing else.
#include "sunbeam/color_converted_bsdf.h"

#include <gtest/gtest.h>

#include "runtime/tracer/lambert.h"

namespace sunbeam {
namespace {

const Vec3 kOut = spherical_direction(0.3, 0), kIn = spherical_direction(0.8, 2);

ColorConvertedBsdf<Lambert> converted(const Rgb& albedo) {
  return {Lambert(albedo), ColorSpace::acescg, ColorSpace::rec709};
}

TEST(ColorConvertedBsdf, ConvertsValuesAndThroughputs) {
  const Rgb albedo(0.1, 0.8, 0.1), expected = rgb_to_rgb(ColorSpace::acescg, ColorSpace::rec709) * albedo;
  const Lambert plain(albedo);
  const auto bsdf = converted(albedo);
  Rng rng(1, 0), same(1, 0);
  EXPECT_LT(expected.r, 0);  // the sign is kept
  const auto sample = bsdf.sample(kOut, rng), original = plain.sample(kOut, same);
  ASSERT_TRUE(sample && original);
  EXPECT_EQ(sample->wi.z, original->wi.z);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(bsdf.eval(kOut, kIn, rng)[c], expected[c] * kInvPi, 1e-15);
    EXPECT_NEAR(sample->throughput[c], expected[c], 1e-14);
  }
}

TEST(ColorConvertedBsdf, ConvertsBothAtOnce) {
  const auto bsdf = converted(Rgb(0.1, 0.8, 0.1));
  Rng together(2, 0), apart(2, 0);
  const auto [eval, sample] = bsdf.eval_and_sample(kOut, kIn, together);
  const auto alone = bsdf.sample(kOut, apart);
  ASSERT_TRUE(sample && alone);
  EXPECT_EQ(eval.f, bsdf.eval(kOut, kIn, apart));
  EXPECT_EQ(eval.pdf, bsdf.mis_pdf(kOut, kIn));
  EXPECT_EQ(sample->throughput, alone->throughput);
  EXPECT_EQ(sample->wi.x, alone->wi.x);
}

TEST(ColorConvertedBsdf, KeepsGreysAndDensities) {
  Rng rng(1, 0);
  const Lambert plain(Rgb(0.4));
  const auto bsdf = converted(Rgb(0.4));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(bsdf.eval(kOut, kIn, rng)[c], 0.4 * kInvPi, 1e-14);
  EXPECT_EQ(bsdf.pdf(kOut, kIn, rng), plain.pdf(kOut, kIn, rng));
  EXPECT_EQ(bsdf.mis_pdf(kOut, kIn), plain.mis_pdf(kOut, kIn));
}

}  // namespace
}  // namespace sunbeam
