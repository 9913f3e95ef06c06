#include "sunbeam/detail/film_stack.h"

#include <gtest/gtest.h>

#include "bake/optics/thin_film.h"
#include "sunbeam/core/rng.h"
#include "tests/support/csv.h"

namespace sunbeam {
namespace {

using Complex = std::complex<double>;

const double kCosines[] = {1, 0.99, 0.8, 0.5, 0.3, 0.1, 0.01};

double number(const std::string& text) {
  double value = 0;
  if (!parse_number(text, value)) throw std::runtime_error("not a number: " + text);
  return value;
}

std::vector<FilmLayer> layers_of(const std::string& text) {
  std::vector<FilmLayer> layers;
  for (const auto& layer : split(text, ';')) {
    const auto parts = split(layer, '/');
    layers.push_back({number(parts.at(0)), {number(parts.at(1)), number(parts.at(2))}});
  }
  return layers;
}

// A clear or an absorbing stack of one to eight layers on a clear base.
FilmStack random_stack(Rng& rng, bool absorbs) {
  FilmStack stack{1 + rng.uniform(), {}, 1 + 2 * rng.uniform()};
  for (std::size_t k = 0; k < 1 + rng.next() % 8; ++k)
    stack.layers.push_back(
        {300 * rng.uniform(), {1 + 1.5 * rng.uniform(), absorbs ? 0.3 * rng.uniform() : 0}});
  return stack;
}

FilmStack reversed(const FilmStack& stack) {
  return {stack.base_index.real(), {stack.layers.rbegin(), stack.layers.rend()}, stack.exterior_ior};
}

double cosine_in_base(const FilmStack& stack, double cosine) {
  return std::sqrt(refracted_cosine_squared(stack.exterior_ior, stack.base_index.real(), cosine));
}

// What the same light from both sides may differ by: near grazing the cosine on the far side has lost digits.
double rounding(const FilmStack& stack, double cosine) {
  return 1e-14 / square(std::min(cosine, cosine_in_base(stack, cosine)));
}

void expect_same(const FilmStack& a, const FilmStack& b, double cosine, double bound) {
  const StackPower power_a = stack_power(a, cosine, 550), power_b = stack_power(b, cosine, 550);
  EXPECT_NEAR(power_a.reflectance, power_b.reflectance, bound);
  EXPECT_NEAR(power_a.transmittance, power_b.transmittance, bound);
}

TEST(FilmStack, ReferenceTable) {
  for (const auto& row : test::read_reference("layered_films.csv")) {
    SCOPED_TRACE("layered_films.csv:" + std::to_string(row.line));
    const FilmStack stack{row.number("exterior_ior"),
                          layers_of(row.text("layers")),
                          {row.number("base_ior"), row.number("base_extinction")}};
    const double cosine = std::cos(test::radians(row.number("theta_i_deg"))),
                 nm = row.number("wavelength_nm");
    const StackPower power = stack_power(stack, cosine, nm);
    EXPECT_NEAR(power.reflectance, row.number("reflectance"), 1e-13);
    EXPECT_NEAR(power.transmittance / row.number("transmittance"), 1, 1e-13);
    const auto below = reflectance_below(stack, cosine, nm);
    ASSERT_EQ(below.has_value(), row.has("reflectance_below"));
    if (below) {
      EXPECT_NEAR(*below, row.number("reflectance_below"), 1e-13);
    }
  }
}

TEST(FilmStack, OneClearLayerIsTheThinFilm) {
  Rng rng(1, 0);
  for (int k = 0; k < 2000; ++k) {
    const ThinFilm film{1 + rng.uniform(), 1 + rng.uniform(), 1 + rng.uniform(), 3000 * rng.uniform()};
    const FilmStack stack{film.exterior_ior, {{film.thickness_nm, film.film_ior}}, film.base_ior};
    const double cosine = rng.uniform();
    const StackPower power = stack_power(stack, cosine, 550);
    const FilmPower expected = airy(film, cosine, Rgb(550));
    EXPECT_NEAR(power.reflectance, expected.reflectance.r, 1e-12) << k;
    EXPECT_NEAR(power.transmittance, expected.transmittance.r, 1e-12 * expected.transmittance.r) << k;
  }
}

TEST(FilmStack, ClearStacksKeepAllPowerAndReflectAlikeFromBothSides) {
  Rng rng(2, 0);
  for (int k = 0; k < 2000; ++k) {
    const FilmStack stack = random_stack(rng, false);
    const double cosine = rng.uniform();
    const StackPower power = stack_power(stack, cosine, 400 + 300 * rng.uniform());
    EXPECT_NEAR(power.reflectance + power.transmittance, 1, 1e-13) << k;
    const auto below = reflectance_below(stack, cosine, 550);
    if (!below) continue;
    EXPECT_NEAR(*below, stack_power(stack, cosine, 550).reflectance, rounding(stack, cosine)) << k;
  }
}

TEST(FilmStack, AbsorbingStacksLosePowerAndLetThroughTheSameBothWays) {
  Rng rng(3, 0);
  int crossings = 0;
  for (int k = 0; k < 2000; ++k) {
    const FilmStack stack = random_stack(rng, true);
    const double cosine = rng.uniform();
    const StackPower power = stack_power(stack, cosine, 550);
    EXPECT_LT(power.reflectance + power.transmittance, 1) << k;
    if (!reflectance_below(stack, cosine, 550)) continue;
    const StackPower below = stack_power(reversed(stack), cosine_in_base(stack, cosine), 550);
    EXPECT_NEAR(below.transmittance / power.transmittance, 1, rounding(stack, cosine)) << k;
    EXPECT_EQ(below.reflectance, reflectance_below(stack, cosine, 550)) << k;
    ++crossings;
  }
  EXPECT_GT(crossings, 1000);
}

TEST(FilmStack, EqualLayersAreOneAndLayersOfNoThicknessAreNone) {
  const Complex n(1.7, 0.05);
  const FilmStack one{1, {{900, n}}, 1.4};
  const FilmStack parts{1, {{100, n}, {0, {2.4, 1}}, {300, n}, {500, n}, {0, 1.2}}, 1.4};
  for (const double cosine : kCosines) expect_same(one, parts, cosine, 1e-14);
  EXPECT_NEAR(stack_power({1, {}, 1.5}, 1, 550).reflectance, 0.04, 1e-15);
  EXPECT_NEAR(stack_power({1, {}, 1.5}, 1, 550).transmittance, 0.96, 1e-15);
}

TEST(FilmStack, LayersOfHalfAWaveAreInvisibleAndOneOfAQuarterDoesNotReflect) {
  const FilmStack half{1, {{275.0 / 2.3, 2.3}}, 1.5},
      quarter{1.2, {{137.5 / std::sqrt(1.2 * 1.8), std::sqrt(1.2 * 1.8)}}, 1.8};
  EXPECT_NEAR(stack_power(half, 1, 550).reflectance, 0.04, 1e-15);
  EXPECT_NEAR(stack_power(quarter, 1, 550).reflectance, 0, 1e-30);
}

TEST(FilmStack, MetalAtNormalIncidence) {
  for (const Complex n : {Complex(0.05, 4), Complex(2.7, 3.2), Complex(10, 0.1)}) {
    const double k2 = n.imag() * n.imag();
    const double expected = ((n.real() - 1) * (n.real() - 1) + k2) / ((n.real() + 1) * (n.real() + 1) + k2);
    const StackPower power = stack_power({1, {}, n}, 1, 550);
    EXPECT_NEAR(power.reflectance, expected, 1e-15);
    EXPECT_NEAR(power.transmittance, 1 - expected, 1e-15);
    EXPECT_FALSE(reflectance_below({1, {}, n}, 1, 550));
  }
}

TEST(FilmStack, QuarterWavePairsAreTheBraggMirror) {
  const double high = 2.3, low = 1.4, base = 1.5;
  FilmStack stack{1, {}, base};
  for (int m = 1; m <= 30; ++m) {
    stack.layers.push_back({137.5 / high, high});
    stack.layers.push_back({137.5 / low, low});
    const double b = base * std::pow(high / low, 2 * m);
    EXPECT_NEAR(stack_power(stack, 1, 550).reflectance, square((1 - b) / (1 + b)), 1e-13) << m;
    EXPECT_NEAR(stack_power(stack, 1, 550).transmittance * square(1 + b) / (4 * b), 1, 1e-11) << m;
  }
}

// T of one layer alone, whose inner reflections are damped away: (1 - R) at both sides and exp(-4 pi k d /
// lambda).
TEST(FilmStack, ThickAbsorbingLayersNeitherOverflowNorLoseDigits) {
  const Complex n(1.6, 0.5);
  const double t = std::norm(2.0 / (1.0 + n)) * std::norm(2.0 * n / (n + 1.5)) * 1.5;
  for (const double d : {3000.0, 10000.0, 30000.0}) {
    const StackPower power = stack_power({1, {{d, n}}, 1.5}, 1, 550);
    EXPECT_NEAR(power.transmittance / (t * std::exp(-4 * kPi * 0.5 * d / 550)), 1, 1e-11) << d;
    EXPECT_NEAR(power.reflectance, std::norm((n - 1.0) / (n + 1.0)), 1e-14) << d;
  }
  EXPECT_EQ(stack_power({1, {{1e9, n}}, 1.5}, 0.3, 380).transmittance, 0);
}

TEST(FilmStack, BeyondTheCriticalAngleAllIsReflectedByClearLayersAlone) {
  const double cosine = 0.3;  // sin = 0.95
  for (const double d : {0.0, 50.0, 1e6}) {
    const StackPower clear = stack_power({1.5, {{d, 1.3}}, 1.2}, cosine, 550);
    EXPECT_NEAR(clear.reflectance, 1, 1e-15);
    EXPECT_EQ(clear.transmittance, 0);
  }
  const StackPower absorbing = stack_power({1.5, {{50, {1.3, 0.1}}}, 1.2}, cosine, 550);
  EXPECT_LT(absorbing.reflectance, 0.9);
  EXPECT_EQ(absorbing.transmittance, 0);
  EXPECT_FALSE(reflectance_below({1.5, {}, 1.2}, cosine, 550));
}

// The cosine in a layer is exactly 0, which is its limit from both sides.
TEST(FilmStack, GrazingWithinALayerIsSmooth) {
  const FilmStack stack{2, {{200, 1.6}, {100, 1.2}}, 1.9};
  const double critical = 0.6;  // 2 * 0.8 = 1.6
  const StackPower at = stack_power(stack, critical, 550);
  for (const double nearby : {critical - 1e-9, critical + 1e-9})
    EXPECT_NEAR(stack_power(stack, nearby, 550).reflectance, at.reflectance, 1e-7);
  EXPECT_NEAR(at.reflectance + at.transmittance, 1, 1e-13);
  EXPECT_EQ(stack_power(stack, 0, 550).reflectance, 1);
}

}  // namespace
}  // namespace sunbeam
