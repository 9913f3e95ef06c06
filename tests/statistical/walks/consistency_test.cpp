// eval(), sample() and pdf() of the live model describe the same surface, in every configuration. Fixed
// seeds; the stated rates of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "bake/live/live_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/configurations.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4);
const Vec3 kSteep = spherical_direction(0.3, 2.5);

// Heroes are drawn in full. 32 tests, false alarm 1e-3 in all.
TEST(Consistency, SamplesFollowThePdf) {
  for (const auto& [name, material, wavelengths] : test::all_configurations())
    for (const Vec3& wo : {kOblique, kSteep}) {
      const auto result =
          test::chi_square_of_sampling(LiveBsdf(material, wavelengths), wo, {.samples = 100000}, 1);
      EXPECT_GT(result.p_value, test::sidak(1e-3, 32)) << name << " cos " << wo.z;
      EXPECT_GT(result.degrees, 200) << name;
    }
}

// 22 tests, false alarm 1e-3 in all.
TEST(Consistency, SamplesOfTheGeneralStackFollowThePdf) {
  const auto follow = [](const test::NamedMaterial& mode, const Spectrum& spectrum, const Vec3& wo) {
    const auto& [name, material] = mode;
    const auto result = test::chi_square_of_sampling(LiveBsdf(material, spectrum.wavelengths(material)), wo,
                                                     {.samples = 100000, .points = 3, .pdf_samples = 16}, 1);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 22)) << name << " cos " << wo.z;
    EXPECT_GT(result.degrees, 200) << name;
  };
  const auto spectra = test::both_spectra();
  for (const auto& mode : test::general_modes()) {
    follow(mode, spectra[0].second, kOblique);
    follow(mode, spectra[1].second, kSteep);
  }
}

// A grazing view of a stronger pigment: other densities at the base, shadowing at the film. 16 tests, 1e-3 in
// all.
TEST(Consistency, SamplesFollowThePdfAtGrazing) {
  for (const auto& [name, material, wavelengths] : test::in_both_spectra(test::all_modes(0.6, 0.8))) {
    const auto result = test::chi_square_of_sampling(LiveBsdf(material, wavelengths),
                                                     spherical_direction(1.35, 0), {.samples = 100000}, 2);
    EXPECT_GT(result.p_value, test::sidak(1e-3, 16)) << name;
  }
}

// Under a liquid, beyond total reflection at the macro surface, where few facets let light pass: rough films,
// facets met once and many times. 8 tests, 1e-3 in all.
TEST(Consistency, SamplesFollowThePdfBeyondTotalReflection) {
  for (auto [name, material] : test::all_modes(0.3))
    for (const auto microfacet : {Microfacet::single, Microfacet::multiple}) {
      if (material.is_smooth()) continue;
      material.exterior_ior = 1.5;
      material.microfacet = microfacet;
      const auto result = test::chi_square_of_sampling(LiveBsdf(material), spherical_direction(1.35, 0),
                                                       {.samples = 50000, .points = 2, .pdf_samples = 16}, 2);
      EXPECT_GT(result.p_value, test::sidak(1e-3, 8)) << name << ' ' << to_string(microfacet);
      EXPECT_GE(result.degrees, 100) << name;
    }
}

// 16 configurations x 2 techniques x 3 channels at 4.5 standard errors (7e-6): 7e-4 in all.
TEST(Consistency, EvalIsReciprocal) {
  const Vec3 a = spherical_direction(0.4, 0), b = spherical_direction(1.2, 2);
  for (const auto& [name, material, wavelengths] : test::all_configurations())
    for (const auto technique : {Technique::unidirectional, Technique::bidirectional}) {
      const LiveBsdf bsdf(material, wavelengths, technique);
      const auto gap = test::reciprocity_gap(bsdf, a, b, 20000, 4);
      const Rgb value = Pfmc(material, wavelengths).first(a, b) + ExactRest(material, wavelengths).rest(a, b);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(gap[c].mean(), 0, 4.5 * gap[c].std_error() + 1e-12) << name << " channel " << c;
        EXPECT_LT(gap[c].std_error(), 0.004 * value[c]) << name << " channel " << c;
      }
    }
}

// Bidirectional, its roles differ. 22 configurations x 3 channels at 4.5 standard errors: 5e-4 in all.
TEST(Consistency, EvalOfTheGeneralStackIsReciprocal) {
  const Vec3 a = spherical_direction(0.4, 0.3), b = spherical_direction(1.1, 2);
  for (const auto& [name, material, wavelengths] : test::general_configurations()) {
    const LiveBsdf bsdf(material, wavelengths, Technique::bidirectional);
    const auto gap = test::reciprocity_gap(bsdf, a, b, 20000, 4);
    Rng rng(4, 1);
    test::RgbMean value;
    for (int i = 0; i < 2000; ++i) value.add(bsdf.eval(a, b, rng));
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(gap[c].mean(), 0, 4.5 * gap[c].std_error()) << name << " channel " << c;
      EXPECT_LT(gap[c].std_error(), 0.02 * value[c].mean()) << name << " channel " << c;
    }
  }
}

// 11 x 3 tests at 4.5 standard errors: 3e-4 in all.
TEST(Consistency, TechniquesOfTheGeneralStackAgree) {
  for (const auto& [name, material] : test::general_modes()) {
    const Pfmc model(material);
    Rng rng(5, 0);
    test::RgbMean one, two;
    for (int i = 0; i < 20000; ++i) {
      one.add(model.estimate_rest(kOblique, kSteep, rng, Technique::unidirectional));
      two.add(model.estimate_rest(kOblique, kSteep, rng, Technique::bidirectional));
    }
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(test::deviation(one[c].mean(), one[c].std_error(), two[c].mean(), two[c].std_error()), 4.5)
          << name << " channel " << c;
  }
}

TEST(Consistency, SameStreamSameBits) {
  for (const auto& [name, material, wavelengths] : test::every_configuration()) {
    const LiveBsdf bsdf(material, wavelengths), again(material, wavelengths);
    Rng a(6, 7), b(6, 7);
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(bsdf.eval(kOblique, kSteep, a), again.eval(kOblique, kSteep, b)) << name;
      EXPECT_EQ(bsdf.pdf(kOblique, kSteep, a), again.pdf(kOblique, kSteep, b)) << name;
      const auto s = bsdf.sample(kOblique, a), t = again.sample(kOblique, b);
      ASSERT_EQ(s.has_value(), t.has_value());
      if (!s) continue;
      EXPECT_EQ(s->throughput, t->throughput);
      EXPECT_EQ(s->wi.x, t->wi.x);
    }
    EXPECT_EQ(a.next(), b.next()) << name;  // and the same numbers were used up
  }
}

// Noise is fresh on every call: nothing is derived from the directions.
TEST(Consistency, RepeatedCallsDiffer) {
  const LiveBsdf bsdf(test::all_modes().back().material);
  Rng rng(7, 0);
  EXPECT_NE(bsdf.eval(kOblique, kSteep, rng), bsdf.eval(kOblique, kSteep, rng));
}

TEST(Consistency, NothingBelowTheHorizon) {
  const Vec3 below = spherical_direction(2, 0);
  for (const auto& [name, material, wavelengths] : test::every_configuration()) {
    const LiveBsdf bsdf(material, wavelengths);
    Rng rng(8, 0);
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(is_black(bsdf.eval(kOblique, below, rng))) << name;
      EXPECT_TRUE(is_black(bsdf.eval(below, kOblique, rng))) << name;
      EXPECT_EQ(bsdf.pdf(kOblique, below, rng), 0) << name;
      EXPECT_EQ(bsdf.pdf(below, kOblique, rng), 0) << name;
      EXPECT_FALSE(bsdf.sample(below, rng)) << name;
      const auto s = bsdf.sample(kOblique, rng);
      if (!s) continue;
      EXPECT_GT(s->wi.z, 0) << name;
      EXPECT_NEAR(length(s->wi), 1, 1e-12) << name;
    }
  }
}

// A walk of three wavelengths and three walks of one have the same mean. 8 x 3 x 2 tests at 4.5 standard
// errors.
TEST(Consistency, ThreeWavelengthsAreThreeMonochromaticRuns) {
  constexpr int kWalks = 40000;
  for (const auto& [name, material] : test::all_modes()) {
    const LiveBsdf coloured(material);
    const auto sampled = test::sample_totals(coloured, kOblique, kWalks, 9).albedo;
    Rng rng(9, 0);
    test::RgbMean evaluated;
    for (int i = 0; i < kWalks; ++i) evaluated.add(coloured.eval(kOblique, kSteep, rng));
    for (int c = 0; c < 3; ++c) {
      Material one = material;
      one.albedo = Rgb(material.albedo[c]);
      const LiveBsdf single(one, Wavelengths::monochromatic(one, Wavelengths::rgb3(material).nm[c]));
      const auto s = test::sample_totals(single, kOblique, kWalks, 10 + c).albedo[c];
      EXPECT_LT(test::deviation(sampled[c].mean(), sampled[c].std_error(), s.mean(), s.std_error()), 4.5)
          << name << " channel " << c;
      test::RunningMean e;
      for (int i = 0; i < kWalks; ++i) e.add(single.eval(kOblique, kSteep, rng)[c]);
      EXPECT_LT(test::deviation(evaluated[c].mean(), evaluated[c].std_error(), e.mean(), e.std_error(),
                                1e-12 * e.mean()),
                4.5)
          << name << " channel " << c;
    }
  }
}

// Mean of the throughput at a direction is f cos / pdf: compared as integrals against three test functions of
// wi, which a common factor or a swapped cosine would upset differently. 19 x 3 at 4.5 standard errors.
TEST(Consistency, ThroughputIsValueOverDensity) {
  const auto weigh = [](const Vec3& w, int k) { return k == 0 ? w.z : k == 1 ? square(w.x) : 1 + w.x; };
  for (const auto& [name, material] : test::every_mode()) {
    const LiveBsdf bsdf(material, Wavelengths::rgb3(material),
                        material.is_plain() ? Technique::unidirectional : Technique::bidirectional);
    for (int k = 0; k < 3; ++k) {
      Rng rng(11, k);
      test::RunningMean by_sample, by_eval;
      for (int i = 0; i < 100000; ++i) {
        const auto s = bsdf.sample(kOblique, rng);
        by_sample.add(s && !s->is_dirac ? mean(s->throughput) * weigh(s->wi, k) : 0);
      }
      const int repeats = material.is_plain() ? 32 : 6;
      for (const double total : test::integrate_stratified(50, repeats, rng, [&](const Vec3&wi, Rng&r) {
             return mean(bsdf.eval(kOblique, wi, r)) * wi.z * weigh(wi, k);
           }))
        by_eval.add(total);
      EXPECT_LT(test::deviation(by_sample.mean(), by_sample.std_error(), by_eval.mean(), by_eval.std_error()),
                4.5)
          << name << " function " << k;
      EXPECT_LT(std::hypot(by_sample.std_error(), by_eval.std_error()),
                (material.is_plain() ? 0.005 : 0.012) * by_eval.mean())
          << name;
    }
  }
}

}  // namespace
}  // namespace sunbeam
