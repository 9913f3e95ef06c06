// Means of random estimates until they are known well enough, and their comparison.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "bake/live/pfmc.h"
#include "sunbeam/bsdf.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam::test {

inline constexpr Technique kTechniques[] = {Technique::unidirectional, Technique::bidirectional};
inline const char* name_of(Technique t) {
  return t == Technique::unidirectional ? "unidirectional" : "bidirectional";
}

struct Effort {
  double error = 1e-3;      // standard error wanted in every channel, relative to its mean
  double absolute = 1e-12;  // or this
  int least = 2000, most = 2000000;
};

template <class Once>
RgbMean until_known(const Effort& effort, Once once) {
  RgbMean mean;
  const auto is_known = [&](int c) {
    return mean[c].std_error() <= std::max(effort.absolute, effort.error * std::abs(mean[c].mean()));
  };
  do
    for (int i = 0; i < effort.least; ++i) mean.add(once());
  while (mean.r.count() < effort.most && !(is_known(0) && is_known(1) && is_known(2)));
  return mean;
}

inline RgbMean mean_rest(const Pfmc& pfmc, const Vec3& wo, const Vec3& wi, Technique technique,
                         const Effort& effort, Rng& rng) {
  return until_known(effort, [&] { return pfmc.estimate_rest(wo, wi, rng, technique); });
}

inline RgbMean sampled_albedo(const Bsdf& bsdf, const Vec3& wo, const Effort& effort, Rng& rng) {
  return until_known(effort, [&] {
    const auto s = bsdf.sample(wo, rng);
    return s ? s->throughput : Rgb();
  });
}

// In each channel to `sigmas` standard errors of their difference, after forgiving a relative `slack`.
inline void expect_agree(const RgbMean& found, const RgbMean& expected, double sigmas, double slack,
                         const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(found[c].mean(), expected[c].mean(),
                sigmas * std::hypot(found[c].std_error(), expected[c].std_error()) +
                    slack * std::abs(expected[c].mean()) + 1e-12)
        << what << ", channel " << c;
}
inline void expect_agree(const RgbMean& found, const Rgb& expected, double sigmas, double slack,
                         const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(found[c].mean(), expected[c],
                sigmas * found[c].std_error() + slack * std::abs(expected[c]) + 1e-12)
        << what << ", channel " << c;
}

}  // namespace sunbeam::test
