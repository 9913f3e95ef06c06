// Estimators of the rest over many materials and directions: every two that answer differ by what their
// errors say, and the others refuse the material by name.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "bake/check/walked_mean.h"
#include "bake/live/adding_doubling/slab_solver.h"
#include "bake/live/estimator.h"
#include "bake/live/exact/exact.h"
#include "tests/support/error_of.h"
#include "tests/support/random_materials.h"
#include "tests/support/stats.h"

namespace sunbeam::test {

// One answer in one channel.
struct Answer {
  double value, error;
};

struct SweepCase {
  int number;            // of the material
  std::uint64_t stream;  // no other case has it
  Material material;
  Wavelengths wavelengths;
  Vec3 wi, wo;

  int channel() const { return number % 3; }
};

inline constexpr int kPairs = 4;  // of directions, for each material

inline void add_cases(int number, const Material& material, const Wavelengths& wavelengths,
                      RandomMaterials& random, std::vector<SweepCase>& cases) {
  EXPECT_FALSE(material.defect()) << material.defect()->message();
  for (int pair = 0; pair < kPairs; ++pair) {
    const Vec3 wi = random.direction(), wo = random.direction();
    cases.push_back({number, std::uint64_t(kPairs) * number + pair, material, wavelengths, wi, wo});
  }
}

// Cases of random materials, each from a stream of its own. film_of(rng, number, material) returns the
// wavelengths of a material, which it may change.
template <class FilmOf>
std::vector<SweepCase> draw_cases(std::uint64_t seed, int first, int count, FilmOf film_of) {
  std::vector<SweepCase> cases;
  for (int number = first; number < first + count; ++number) {
    Rng rng(seed, number);
    RandomMaterials random(rng);
    Material material = random.draw(number);
    const Wavelengths wavelengths = film_of(rng, number, material);
    add_cases(number, material, wavelengths, random, cases);
  }
  return cases;
}

inline Answer walked(const SweepCase& c, Technique technique, int estimates, std::uint64_t seed) {
  const Pfmc pfmc(c.material, c.wavelengths);
  Rng rng(seed, 4 * c.stream + (technique == Technique::bidirectional ? 1 : 0));
  const WalkedMean mean =
      walked_mean(estimates, [&] { return pfmc.estimate_rest(c.wo, c.wi, rng, technique); });
  return {mean.value[c.channel()], mean.standard_error[c.channel()]};
}

inline double solved(const SweepCase& c) {
  SlabSolver solver(c.material, {c.wi.z, c.wo.z});
  const double depth = c.material.optical_depth();
  solver.add_depth(depth);
  const auto rest = SlabSolver::Film(solver, c.material.film_thickness_nm, c.wavelengths).rest(depth);
  return rest.at(1, 0, azimuth(c.wo) - azimuth(c.wi))[c.channel()];
}

// The answer without noise, with the error of its quadrature (docs/theory/live.md,
// docs/theory/scattering.md); else a refusal that names the key.
inline std::optional<Answer> exact(const SweepCase& c) {
  const Material& m = c.material;
  const std::string refusal = error_of([&] { estimator_for_truth(Estimator::exact, m); });
  if (ExactRest::is_valid_for(m)) {
    EXPECT_EQ(refusal, "");
    const double value = ExactRest(m, c.wavelengths).rest(c.wo, c.wi)[c.channel()];
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
inline std::vector<Answer> answers(const SweepCase& c, int estimates, std::uint64_t seed) {
  std::vector<Answer> result;
  for (const Technique technique : {Technique::unidirectional, Technique::bidirectional})
    result.push_back(walked(c, technique, estimates, seed));
  if (const auto truth = exact(c)) result.push_back(*truth);
  return result;
}

// The difference of two in standard errors.
inline double z_score(const Answer& a, const Answer& b) {
  return (a.value - b.value) / std::hypot(a.error, b.error);
}

inline std::string describe(const SweepCase& c) {
  std::string text = std::to_string(c.number);
  for (const std::string& key : material_keys()) text += " " + key + " " + get_text(c.material, key);
  return text + " cosines " + std::to_string(c.wi.z) + " " + std::to_string(c.wo.z);
}

inline constexpr double kFar = 5;

// What all pairs together say.
struct Scores {
  RunningMean squared;
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
    ::testing::Test::RecordProperty("pairs", static_cast<int>(squared.count()));
    ::testing::Test::RecordProperty("deviation", std::to_string(deviation()));
    ::testing::Test::RecordProperty("largest", std::to_string(largest));
  }
};

inline Scores compare_rests(const std::vector<SweepCase>& cases, int estimates) {
  Scores scores;
  for (const SweepCase& c : cases) {
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

inline Answer sampled_albedo(const SweepCase& c, int samples, std::uint64_t seed) {
  const Pfmc pfmc(c.material, c.wavelengths);
  Rng rng(seed, 4 * c.stream + 2);
  const WalkedMean mean = walked_mean(samples, [&] {
    const auto sample = pfmc.sample(c.wi, rng);
    return sample ? sample->throughput : Rgb();
  });
  return {mean.value[c.channel()], mean.standard_error[c.channel()]};
}

inline Scores compare_albedos(const std::vector<SweepCase>& cases, int samples) {
  Scores scores;
  for (const SweepCase& c : cases) {
    if (!ExactRest::is_valid_for(c.material)) continue;
    const double value = ExactRest(c.material, c.wavelengths).albedo(c.wi)[c.channel()];
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
inline void expect_normal(const Scores& scores, int count, int far, double slack) {
  EXPECT_GE(scores.squared.count(), count);
  EXPECT_LE(scores.far, far);
  EXPECT_GE(scores.deviation(), 1 - slack);
  EXPECT_LE(scores.deviation(), 1 + slack);
}

}  // namespace sunbeam::test
