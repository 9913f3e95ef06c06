// Look-ups at wavelengths: their fold is that of the table, and what cannot be answered is refused.
#include "sunbeam/spectral_bsdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/bsdf_checks.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

constexpr Parameters kAt = {250, 1.45, 0.1};

std::string refusal(const Table& table, const Parameters& at, std::vector<double> nm) {
  try {
    SpectralBsdf(table, at, nm);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

// At nodes of S and Q bound look-ups have what these fold to, but for the film's reflectance between its
// nodes.
TEST(SpectralBsdf, FoldsToTheTable) {
  for (const Table& table : test::factored_tables()) {
    const Wavelengths& wavelengths = table.factors.wavelengths;
    const SpectralBsdf spectral(table, kAt, wavelengths.nm);
    const TableBsdf bound = table.bind(kAt);
    std::vector<double> f(spectral.size());
    for (const double o : {0.25, 0.5625, 1.0})
      for (const double i : {0.25, 0.5625, 1.0}) {
        if (o > i) continue;  // bound look-ups rely on reciprocity, which random arrays lack
        const Vec3 wo = direction_from_cosine(o, 0), wi = direction_from_cosine(i, 0);
        spectral.eval(wo, wi, f);
        const Rgb folded = wavelengths.fold(f), expected = bound.eval(wo, wi);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(folded[c], expected[c], 1e-4 * std::abs(expected[c]))
              << to_string(table.material.roughness) << ' ' << o << ' ' << i << ' ' << c;
      }
  }
}

TEST(SpectralBsdf, FoldsToABakedTableEverywhere) {
  const Table table = load_table_exr(std::string(SUNBEAM_SOURCE_DIR) + "/tables/golden/preview.exr");
  const Parameters at = {430, 1, 0.7};
  const SpectralBsdf spectral(table, at, table.factors.wavelengths.nm);
  const TableBsdf bound = table.bind(at);
  std::vector<double> f(spectral.size());
  double difference = 0, sum = 0;
  Rng rng(1, 0);
  for (int k = 0; k < 500; ++k) {
    const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    spectral.eval(wo, wi, f);
    const Rgb folded = table.factors.wavelengths.fold(f), expected = bound.eval(wo, wi);
    difference += std::abs(folded.g - expected.g);
    sum += std::abs(expected.g);
  }
  EXPECT_LT(difference, 1e-4 * sum);
}

// Of a wavelength in the list it does not matter which others are there.
TEST(SpectralBsdf, WavelengthsAreIndependent) {
  for (const Table& table : test::factored_tables()) {
    const Interval range = spectral_range(table);
    const double middle = lerp(0.37, range.low, range.high);
    const SpectralBsdf one(table, kAt, std::array{middle}),
        many(table, kAt, std::array{range.low, middle, range.high});
    double alone, among[3];
    const Vec3 wo = direction_from_cosine(0.7, 0.4), wi = direction_from_cosine(0.5, 2);
    one.eval(wo, wi, {&alone, 1});
    many.eval(wo, wi, among);
    EXPECT_NEAR(alone, among[1], 1e-9 * alone);
    EXPECT_GT(alone, 0);
  }
}

// The mean of throughputs is Int f cos dwi; 4.5 standard errors, false alarm 7e-6 a wavelength.
TEST(SpectralBsdf, SamplesAreUnbiased) {
  for (const Table& table : test::factored_tables()) {
    const Interval range = spectral_range(table);
    const SpectralBsdf bsdf(table, kAt, std::array{range.low, range.high});
    const Vec3 wo = direction_from_cosine(0.6, 1);
    Rng rng(3, 0);
    test::RunningMean drawn[2], uniform[2];
    double values[2], mirror[2];
    bsdf.dirac(wo, mirror);
    for (int k = 0; k < 20000; ++k) {
      const auto sample = bsdf.sample(wo, random3(rng), values);
      for (int c = 0; c < 2; ++c) drawn[c].add(sample ? values[c] : 0);
      const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
      bsdf.eval(wo, wi, values);
      for (int c = 0; c < 2; ++c) uniform[c].add(values[c] * wi.z * 2 * kPi + mirror[c]);
    }
    for (int c = 0; c < 2; ++c)
      EXPECT_NEAR(drawn[c].mean(), uniform[c].mean(),
                  4.5 * std::hypot(drawn[c].std_error(), uniform[c].std_error()) + 1e-4)
          << to_string(table.material.roughness);
  }
}

TEST(SpectralBsdf, RefusesWhatItCannotAnswer) {
  const Table table = test::small_factored_table();
  const Interval range = spectral_range(table);
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal(table, kAt, {range.high + 1}), HasSubstr("the table holds"));
  EXPECT_THAT(refusal(table, kAt, {range.low - 1}), HasSubstr("wavelength: found"));
  EXPECT_THAT(refusal(table, kAt, {std::nan("")}), HasSubstr("wavelength: found"));
  EXPECT_THAT(refusal(table, kAt, {}), HasSubstr("wavelengths: found 0"));
  EXPECT_THAT(refusal(table, {9000, 1.45, 0.1}, {range.low}), HasSubstr("key 'film_thickness_nm'"));
  EXPECT_THAT(refusal(test::small_table(), kAt, {500}), HasSubstr("dense"));
}

}  // namespace
}  // namespace sunbeam
