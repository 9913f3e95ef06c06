#include "sunbeam/core/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace sunbeam {
namespace {

// Numbers of a separate implementation (Python integers) of SplitMix64 seeding PCG-XSH-RR 64/32.
TEST(Rng, PinnedFirstNumbers) {
  struct Case {
    std::uint64_t seed, stream;
    std::array<std::uint32_t, 4> first;
  };
  const std::vector<Case> cases = {{0, 0, {0x47f2adc1u, 0xbd54df55u, 0x3327ff1cu, 0x750fa069u}},
                                   {1, 2, {0x424613e1u, 0x70d8d5a4u, 0xbc6aede9u, 0x5537f208u}},
                                   {~0ull, 12345, {0x374595b3u, 0x76eb008bu, 0xe0f472f9u, 0xcd09bbedu}}};
  for (const auto& c : cases) {
    Rng rng(c.seed, c.stream);
    for (const auto expected : c.first) EXPECT_EQ(rng.next(), expected) << c.seed << ", " << c.stream;
  }
}

TEST(Rng, UniformIsTheWordOverTwoToThe32) {
  Rng words(5, 6), numbers(5, 6);
  for (int i = 0; i < 1000; ++i) {
    const double u = numbers.uniform();
    EXPECT_EQ(u, words.next() / 4294967296.0);
    EXPECT_LT(u, 1);
  }
}

TEST(Rng, CopiesGoOnAlike) {
  Rng a(7, 8);
  a.next();
  Rng b = a;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(a.next(), b.next());
}

double correlation(Rng a, Rng b, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += (a.uniform() - 0.5) * (b.uniform() - 0.5);
  return sum / count * 12;  // Var(uniform) = 1/12
}

// Neighbouring streams and neighbouring seeds. sqrt(n) correlation is a normal deviate: 5 of them in 128
// pairs are a false alarm of 7e-5.
TEST(Rng, NeighboursAreUncorrelated) {
  constexpr int kCount = 4096;
  for (std::uint64_t k = 0; k < 64; ++k) {
    EXPECT_LT(std::abs(correlation({1, k}, {1, k + 1}, kCount)) * std::sqrt(kCount), 5) << "stream " << k;
    EXPECT_LT(std::abs(correlation({k, 1}, {k + 1, 1}, kCount)) * std::sqrt(kCount), 5) << "seed " << k;
  }
}

// First numbers over streams: a renderer takes a few numbers from each of many streams. Mean of n uniforms
// has deviation 1 / sqrt(12 n), their mean square 1/3 has sqrt(4/45 / n); 5 of them: 1e-6 in all.
TEST(Rng, FirstNumbersAreUniformOverStreams) {
  constexpr int kStreams = 100000;
  double sum = 0, squares = 0;
  for (int k = 0; k < kStreams; ++k) {
    const double u = Rng(3, k).uniform();
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / kStreams, 0.5, 5 / std::sqrt(12.0 * kStreams));
  EXPECT_NEAR(squares / kStreams, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kStreams));
}

}  // namespace
}  // namespace sunbeam
