// The errors that estimators of the rest state: over random materials and directions, every two estimators
// that answer differ by what their errors say, and the others refuse the material by name.
#include <gtest/gtest.h>

#include <optional>

#include "bake/check/walked_mean.h"
#include "bake/live/adding_doubling/slab_solver.h"
#include "bake/live/estimator.h"
#include "bake/live/exact/exact.h"
#include "tests/support/csv.h"
#include "tests/support/error_of.h"
#include "tests/support/estimates.h"
#include "tests/support/random_materials.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

using test::radians;

// One answer in one channel.
struct Answer {
  double value, error;
};

struct Case {
  int number;            // of the material
  std::uint64_t stream;  // no other case has it
  Material material;
  Vec3 wi, wo;

  int channel() const { return number % 3; }
};

constexpr int kPairs = 4;  // of directions, for each material

std::vector<Case> draw_cases(int first, int count) {
  std::vector<Case> cases;
  for (int number = first; number < first + count; ++number) {
    Rng rng(31, number);
    test::RandomMaterials random(rng);
    const Material material = random.draw(number);
    EXPECT_FALSE(material.defect());
    for (int pair = 0; pair < kPairs; ++pair) {
      const Vec3 wi = random.direction(), wo = random.direction();
      cases.push_back({number, std::uint64_t(kPairs) * number + pair, material, wi, wo});
    }
  }
  return cases;
}

Answer walked(const Case& c, Technique technique, int estimates, std::uint64_t seed) {
  const Pfmc pfmc(c.material);
  Rng rng(seed, 4 * c.stream + (technique == Technique::bidirectional ? 1 : 0));
  const WalkedMean mean =
      walked_mean(estimates, [&] { return pfmc.estimate_rest(c.wo, c.wi, rng, technique); });
  return {mean.value[c.channel()], mean.standard_error[c.channel()]};
}

double solved(const Case& c) {
  const Wavelengths wavelengths = Wavelengths::rgb3(c.material);
  SlabSolver solver(c.material, {c.wi.z, c.wo.z});
  const double depth = c.material.optical_depth();
  solver.add_depth(depth);
  const auto rest = SlabSolver::Film(solver, c.material.film_thickness_nm, wavelengths).rest(depth);
  return rest.at(1, 0, azimuth(c.wo) - azimuth(c.wi))[c.channel()];
}

// The answer without noise, with the error of its quadrature (docs/theory/live.md,
// docs/theory/scattering.md); else a refusal that names the key.
std::optional<Answer> exact(const Case& c) {
  const Material& m = c.material;
  const std::string refusal = test::error_of([&] { estimator_for_truth(Estimator::exact, m); });
  if (ExactRest::is_valid_for(m)) {
    EXPECT_EQ(refusal, "");
    const double value = ExactRest(m, Wavelengths::rgb3(m)).rest(c.wo, c.wi)[c.channel()];
    return Answer{value, 2e-4 * value};
  }
  if (SlabSolver::solves(m)) {
    EXPECT_EQ(refusal, "");
    const double value = solved(c);
    return Answer{value, 1e-3 * value};
  }
  const std::string key = m.scatters() ? "key 'scattering_per_nm'" : "key 'microfacet'";
  EXPECT_NE(refusal.find(key), std::string::npos) << c.number << ": " << refusal;
  return {};
}

// All answers; the exact one comes last.
std::vector<Answer> answers(const Case& c, int estimates, std::uint64_t seed) {
  std::vector<Answer> result;
  for (const Technique technique : {Technique::unidirectional, Technique::bidirectional})
    result.push_back(walked(c, technique, estimates, seed));
  if (const auto truth = exact(c)) result.push_back(*truth);
  return result;
}

// The difference of two in standard errors.
double z_score(const Answer& a, const Answer& b) {
  return (a.value - b.value) / std::hypot(a.error, b.error);
}

std::string describe(const Case& c) {
  std::string text = std::to_string(c.number);
  for (const std::string& key : material_keys()) text += " " + key + " " + get_text(c.material, key);
  return text + " cosines " + std::to_string(c.wi.z) + " " + std::to_string(c.wo.z);
}

constexpr double kFar = 5;

// What all pairs together say.
struct Scores {
  test::RunningMean squared;
  double largest = 0;
  int far = 0;  // pairs that are repeated

  // Noise below the error of a quadrature is not seen, nor is what lies below the least error. Beside noise
  // that is seen, the bound of a quadrature's error counts for nothing.
  void add(const Answer& noisy, const Answer& other, bool is_quadrature) {
    const double z = z_score(noisy, other);
    largest = std::max(largest, std::abs(z));
    far += std::abs(z) > kFar;
    if (noisy.error > (is_quadrature ? 3 * other.error : 0) && noisy.error > kLeastWalkedError)
      squared.add(square(is_quadrature ? (noisy.value - other.value) / noisy.error : z));
  }
  double deviation() const { return std::sqrt(squared.mean()); }
  void record() const {
    testing::Test::RecordProperty("pairs", static_cast<int>(squared.count()));
    testing::Test::RecordProperty("deviation", std::to_string(deviation()));
    testing::Test::RecordProperty("largest", std::to_string(largest));
  }
};

Scores compare_rests(const std::vector<Case>& cases, int estimates) {
  Scores scores;
  for (const Case& c : cases) {
    const auto found = answers(c, estimates, 32);
    std::vector<Answer> again;
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = a + 1; b < found.size(); ++b) {
        scores.add(found[a], found[b], b == 2);
        if (std::abs(z_score(found[a], found[b])) <= kFar) continue;
        if (again.empty()) again = answers(c, 4 * estimates, 33);
        EXPECT_LE(std::abs(z_score(again[a], again[b])), kFar)
            << describe(c) << ", estimators " << a << " and " << b << ": " << again[a].value << " +- "
            << again[a].error << ", " << again[b].value << " +- " << again[b].error;
      }
  }
  scores.record();
  return scores;
}

Answer sampled_albedo(const Case& c, int samples, std::uint64_t seed) {
  const Pfmc pfmc(c.material);
  Rng rng(seed, 4 * c.stream + 2);
  const WalkedMean mean = walked_mean(samples, [&] {
    const auto sample = pfmc.sample(c.wi, rng);
    return sample ? sample->throughput : Rgb();
  });
  return {mean.value[c.channel()], mean.standard_error[c.channel()]};
}

Scores compare_albedos(const std::vector<Case>& cases, int samples) {
  Scores scores;
  for (const Case& c : cases) {
    if (!ExactRest::is_valid_for(c.material)) continue;
    const double value = ExactRest(c.material, Wavelengths::rgb3(c.material)).albedo(c.wi)[c.channel()];
    const Answer truth{value, 2e-4 * value}, found = sampled_albedo(c, samples, 34);
    scores.add(found, truth, true);
    if (std::abs(z_score(found, truth)) <= kFar) continue;
    const Answer again = sampled_albedo(c, 4 * samples, 35);
    EXPECT_LE(std::abs(z_score(again, truth)), kFar)
        << describe(c) << ": " << again.value << " +- " << again.error << ", not " << truth.value;
  }
  scores.record();
  return scores;
}

// At least `count` scores, at most so many `far` ones, and a deviation of 1 but for `slack`.
void expect_normal(const Scores& scores, int count, int far, double slack) {
  EXPECT_GE(scores.squared.count(), count);
  EXPECT_LE(scores.far, far);
  EXPECT_GE(scores.deviation(), 1 - slack);
  EXPECT_LE(scores.deviation(), 1 + slack);
}

// 200 materials. Two in three of the scores are independent, and tell the deviation to 0.03: one seed in a
// thousand fails.
TEST(LongStatedErrors, HoldForEveryPairOfEstimators) {
  expect_normal(compare_rests(draw_cases(0, 200), 3000), 1000, 3, 0.1);
}

// The same for albedos by samples: to 0.035.
TEST(LongStatedErrors, HoldForAlbedos) {
  expect_normal(compare_albedos(draw_cases(0, 200), 20000), 300, 3, 0.1);
}

// The quick version over other materials; some seventy scores tell the deviation to 0.1.
TEST(StatedErrors, HoldForEveryPairOfEstimators) {
  expect_normal(compare_rests(draw_cases(200, 12), 1500), 60, 0, 0.3);
}

// Light that all but few facets reflect totally, of roughness 0.05, under a liquid. The exact evaluator is
// good to 1e-3 there. 2 techniques x 2 paths x 3 channels at 4.5 standard errors, 7e-6 each: 8e-5.
TEST(StatedErrors, HoldBeyondTotalReflection) {
  const Vec3 wi = spherical_direction(radians(75), 0), wo = spherical_direction(radians(40), 2);
  for (const auto path : {AbsorptionPath::sum, AbsorptionPath::product}) {
    Material m;
    m.exterior_ior = 1.4;
    m.base_ior = 1.2;
    m.roughness = 0.05;
    m.absorption_path = path;
    const Rgb truth = ExactRest(m, Wavelengths::rgb3(m)).rest(wo, wi);
    const Pfmc pfmc(m);
    for (const Technique technique : test::kTechniques) {
      Rng rng(36, 0);
      const WalkedMean found = walked_mean(10000, [&] { return pfmc.estimate_rest(wo, wi, rng, technique); });
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found.value[c], truth[c], 4.5 * found.standard_error[c] + 1e-3 * truth[c]);
        EXPECT_LE(found.standard_error[c], 0.025 * truth[c]) << to_string(path) << test::name_of(technique);
      }
    }
  }
}

// A pigment that scatters forwards, against adding and doubling at twice its usual cosines, which is good to
// 1e-3 there. 2 techniques x 3 depths x 3 channels at 4.5 standard errors: 1.2e-4.
TEST(StatedErrors, HoldUnderAForwardPeak) {
  const Vec3 wi = spherical_direction(radians(60), 0), wo = spherical_direction(radians(40), radians(120));
  for (const double depth : {0.3, 1.0, 3.0}) {
    Material m;
    m.roughness = 0.2;
    m.absorption_per_nm = 0.25;
    m.scattering_per_nm = depth / m.pigment_thickness_nm;
    m.anisotropy = 0.9;
    SlabSolver solver(m, {wi.z, wo.z}, {.below = 24, .above = 40});
    solver.add_depth(m.optical_depth());
    const SlabSolver::Film film(solver, m.film_thickness_nm, Wavelengths::rgb3(m));
    const Rgb truth = film.rest(m.optical_depth()).at(1, 0, radians(120));
    const Pfmc pfmc(m);
    for (const Technique technique : test::kTechniques) {
      Rng rng(37, 0);
      const WalkedMean found = walked_mean(5000, [&] { return pfmc.estimate_rest(wo, wi, rng, technique); });
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found.value[c], truth[c], 4.5 * found.standard_error[c] + 1e-3 * truth[c]);
        EXPECT_LE(found.standard_error[c], 0.01 * truth[c]) << depth << test::name_of(technique);
      }
    }
  }
}

}  // namespace
}  // namespace sunbeam
